#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "osteomill/experiment/measure_stability.h"
#include "osteomill/experiment/study.h"
#include "osteomill/recording/recording.h"

namespace osteomill {

/// What was measured beside the recordings.
struct ReportExtras {
  /// The recordings are then those of its first seed.
  std::optional<Study> study;
  std::vector<StabilityRow> stability;
};

/// Writes `out_dir`/report.html, summary.csv and figures/ (each figure as SVG and PNG) from any number of
/// recordings, one for each algorithm, mode and phase that there is; returns the path of report.html. Where
/// there are extras, the page has a section on each, and study.csv and stability.csv hold their numbers.
/// Files appear whole, the page last. Throws InputError where there are no recordings, two are of the same
/// algorithm, mode and phase, one cannot be measured, gnuplot is missing or fails, or a file cannot be
/// written.
std::filesystem::path write_report(const std::vector<Recording>& recordings,
                                   const std::filesystem::path& out_dir, const ReportExtras& extras = {});

}  // namespace osteomill
