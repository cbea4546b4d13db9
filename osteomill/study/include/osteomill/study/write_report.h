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

/// Returns the scan that a recording was made with, as it was read. Throws InputError if it cannot be had.
using ScanOf = std::function<std::shared_ptr<const Volume>(const Recording&)>;

/// A row of the table of metrics, as PageText adds them.
struct MetricLine {
  std::string label;
  std::function<Cell(const MeasuredRun&)> cell;
};

/// The parts of a report that the caller of write_report() adds; any may be empty. A plain session adds none.
struct PageText {
  std::string title = "What was milled, and what the hand felt";
  /// The section at the page's top, with the answer that a reader looks for. Without it the page says there
  /// about each run how long it took, how far the burr went, what was removed and what was felt.
  std::optional<Section> opening;
  /// Sections between those on what was felt and those on settings.
  std::vector<Section> sections;
  /// Lines below the times that any session has.
  std::vector<MetricLine> further_times;
  /// Paragraphs to add to the section on what was run.
  std::vector<std::string> about_the_run;
  /// Notes to add below a figure, by the figure's name ("force").
  std::map<std::string, std::string> caption_notes;
};

/// Writes `out_dir`/report.html, summary.csv and figures/ (each figure as SVG and PNG) of runs that were
/// measured (group_runs); returns the path of report.html. `text` gets the folder for its figures. The page
/// has what matters most first: the opening, the bone before and after, force, torque, shaft and path, each
/// with its figures and metrics, then what `text` adds, times, settings, and how to repeat it, with the
/// figures in itself. If there is a `scan_of`, the bones are milled again and shown in 3D, as far as that
/// makes the page no larger than 5 MB; if a scan is missing, the page says so. All appear together or none.
/// Throws InputError if gnuplot is missing or fails, or a file cannot be written.
std::filesystem::path write_report(
    const RunGroup& runs, const std::filesystem::path& out_dir, const ScanOf& scan_of = {},
    const std::function<PageText(const std::filesystem::path& figures)>& text = [](const auto&) {
      return PageText{};
    });

/// Writes a report of any number of recordings, one for each algorithm and phase. Throws InputError also if
/// there are no recordings, two are of the same algorithm and phase, or one cannot be measured.
std::filesystem::path write_report(const std::vector<Recording>& recordings,
                                   const std::filesystem::path& out_dir, const ScanOf& scan_of = {});

}  // namespace osteomill
