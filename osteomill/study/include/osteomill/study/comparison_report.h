#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/study/measure_passivity.h"
#include "osteomill/study/page.h"
#include "osteomill/study/study.h"
#include "osteomill/study/write_report.h"

namespace osteomill {

/// Measurements beside the recordings.
struct ReportExtras {
  /// Runs in other hands, grips and tremors than the recordings'.
  std::vector<MeasuredRun> others;
  std::vector<PassivityRow> passivity;
  /// Holdings of all algorithms in the same hole, of each hand (hold_in_one_hole).
  std::vector<MeasuredRun> in_one_hole;
};

/// Returns whether these are recordings of the test of section 8.2, and not of anything else that was milled.
bool are_of_comparison(const std::vector<Recording>& recordings);

/// Writes the report of any session (write_report) with what the test of section 8.2 adds: what was compared
/// and the verdict ahead of all, the paper's findings held against it, and a section on each of the extras.
/// Their numbers go into study.csv, stability.csv and one-hole.csv, which are written even if the report
/// fails. If no extras are `measured`, these tables are read where they stand beside the recordings and are
/// of the same comparison, so that the page is the one that the comparison had. Draws no conclusions from
/// recordings that differ in more than the algorithm (differences_table). Returns the page's path, and puts
/// the results, the tables at its top, into `came_out`. Throws as write_report does.
std::filesystem::path write_comparison_report(const std::vector<Recording>& recordings,
                                              const std::filesystem::path& out_dir,
                                              const std::optional<ReportExtras>& measured = {},
                                              std::vector<Table>* came_out = nullptr,
                                              const ScanOf& scan_of = {});

}  // namespace osteomill
