#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/report/study.h"

namespace osteomill {

/// Writes `out_dir`/report.html, summary.csv and figures/ (each figure as SVG and PNG) from any number of
/// recordings, one for each algorithm, mode and phase that there is; returns the path of report.html. Files
/// appear whole, the page last. Throws InputError where there are no recordings, two are of the same
/// algorithm, mode and phase, one cannot be measured, gnuplot is missing or fails, or a file cannot be
/// written.
///
/// With a study, the recordings are those of its first seed; study.csv is written, and the page has a section
/// on it.
std::filesystem::path write_report(const std::vector<Recording>& recordings,
                                   const std::filesystem::path& out_dir,
                                   const std::optional<Study>& study = std::nullopt);

}  // namespace osteomill
