#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/run_groups.h"

namespace osteomill {

/// Returns the scan of a recording, as read from its file. Throws InputError if it is not available.
using ScanOf = std::function<std::shared_ptr<const Volume>(const Recording&)>;

/// A row to add to the table of metrics (PageText).
struct MetricLine {
  std::string label;
  std::function<Cell(const MeasuredRun&)> cell;
};

/// Parts of a report that the caller of write_report() adds; any may be empty. A plain session adds none.
struct PageText {
  std::string title = "Bone removed and forces felt";
  /// Section at the top of the page with the main result. Without it the page lists there, for each run, how
  /// long it took, how far the burr moved, what was removed and what was felt.
  std::optional<Section> opening;
  /// Sections between those on forces and those on settings.
  std::vector<Section> sections;
  /// Rows to append to the table of times.
  std::vector<MetricLine> further_times;
  /// Paragraphs to add to the section on what was run.
  std::vector<std::string> about_the_run;
  /// Notes to add below a figure, keyed by the figure's name ("force").
  std::map<std::string, std::string> caption_notes;
};

/// Writes `out_dir`/report.html, summary.csv and figures/ (each figure as SVG and PNG) for measured runs
/// (group_runs); returns the path of report.html. `text` receives the folder for its figures. The page shows
/// the most important parts first: the opening, the bone before and after, force, torque, shaft and path,
/// each with its figures and metrics, then the sections of `text`, times, settings, and how to repeat it.
/// Figures are embedded. With a `scan_of`, mills the bones again and shows them in 3D within a page size of 5
/// MB; the page has a notice if a scan is missing. All files appear together or not at all. Throws InputError
/// if gnuplot is missing or fails, or a file cannot be written.
std::filesystem::path write_report(
    const RunGroup& runs, const std::filesystem::path& out_dir, const ScanOf& scan_of = {},
    const std::function<PageText(const std::filesystem::path& figures)>& text = [](const auto&) {
      return PageText{};
    });

/// Writes a report of recordings, one for each algorithm and phase. Also throws InputError if there are no
/// recordings, two have the same algorithm and phase, or one cannot be measured.
std::filesystem::path write_report(const std::vector<Recording>& recordings,
                                   const std::filesystem::path& out_dir, const ScanOf& scan_of = {});

}  // namespace osteomill
