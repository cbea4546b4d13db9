#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/run_groups.h"

namespace osteomill {

/// A row of the table of metrics.
struct MetricLine {
  std::string label;
  std::function<Cell(const MeasuredRun&)> cell;
};

/// What whoever made the recordings has to say of them; all of it may be empty. A plain session has nothing.
struct PageText {
  std::string title = "What was milled, and what the hand felt";
  /// At the page's top, what a reader came for. Without it the page says there of each run how long it took,
  /// how far the burr went, what was removed and what was felt.
  std::optional<Section> opening;
  /// Between what was felt and what was set.
  std::vector<Section> sections;
  /// Below the times that any session has.
  std::vector<MetricLine> further_times;
  /// More to say below a figure, by the figure's name ("force").
  std::map<std::string, std::string> caption_notes;
};

/// Writes `out_dir`/report.html, summary.csv and figures/ (each figure as SVG and PNG) of runs that were
/// measured (group_runs); returns the path of report.html. `text` gets the folder for its figures. The page
/// has what matters most first: the opening, the bone before and after, force, torque, shaft and path, each
/// with its figures and metrics, then what `text` adds, times, settings, and how to repeat it, with the
/// figures in itself. All appear together or none. Throws InputError where gnuplot is missing or fails, or a
/// file cannot be written.
std::filesystem::path write_report(
    const RunGroup& runs, const std::filesystem::path& out_dir,
    const std::function<PageText(const std::filesystem::path& figures)>& text = [](const auto&) {
      return PageText{};
    });

/// A report of any number of recordings, one for each algorithm and phase that there is. Throws
/// InputError also where there are no recordings, two are of the same algorithm and phase, or one
/// cannot be measured.
std::filesystem::path write_report(const std::vector<Recording>& recordings,
                                   const std::filesystem::path& out_dir);

}  // namespace osteomill
