#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/report/report_page.h"

namespace osteomill {

/// Writes `out_dir`/report.html, summary.csv and figures/ (each figure as SVG and PNG) of runs that were
/// measured (group_runs); returns the path of report.html. All appear together or none. Throws InputError
/// where gnuplot is missing or fails, or a file cannot be written.
std::filesystem::path write_report(const std::vector<RunGroup>& groups, const std::filesystem::path& out_dir,
                                   const PageText& text = {});

/// The same of any number of recordings, one for each algorithm, mode and phase that there is. Throws
/// InputError also where there are no recordings, two are of the same algorithm, mode and phase, or one
/// cannot be measured.
std::filesystem::path write_report(const std::vector<Recording>& recordings,
                                   const std::filesystem::path& out_dir);

}  // namespace osteomill
