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

/// Measurements in addition to the recordings.
struct ReportExtras {
  /// Runs in other hands, grips and tremors than those of the recordings.
  std::vector<MeasuredRun> others;
  std::vector<PassivityRow> passivity;
  /// Holds of all algorithms in the same hole, for each hand (hold_in_one_hole).
  std::vector<MeasuredRun> in_one_hole;
};

/// Returns whether these recordings are of the test of section 8.2.
bool is_comparison(const std::vector<Recording>& recordings);

/// Writes the report of any session (write_report) plus the parts of the test of section 8.2: first what was
/// compared and the verdict, then the paper's findings tested on it, and a section on each of the extras.
/// Writes their numbers to study.csv, stability.csv and one-hole.csv even if the report fails. Without
/// `measured`, reads these tables if they are next to the recordings and of the same comparison, so that the
/// page is the same as the comparison's own. Draws no conclusions from recordings that differ in more than
/// the algorithm (differences_table). Returns the page's path, and puts the tables of results at its top into
/// `result_tables`. Throws as write_report.
std::filesystem::path write_comparison_report(const std::vector<Recording>& recordings,
                                              const std::filesystem::path& out_dir,
                                              const std::optional<ReportExtras>& measured = {},
                                              std::vector<Table>* result_tables = nullptr,
                                              const ScanOf& scan_of = {});

}  // namespace osteomill
