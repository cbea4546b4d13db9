#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/report/html.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

/// A row of the table of metrics.
struct MetricLine {
  std::string label;
  std::function<std::string(const MeasuredRun&)> cell;
};

/// What whoever made the recordings has to say of them; all of it may be empty. A plain session has nothing.
struct PageText {
  std::string title = "What was milled, and what the hand felt";
  /// At the page's top, what a reader came for. Without it the page says there of each run how long it took,
  /// how far the burr went, what was removed and what was felt.
  std::optional<PageSection> opening;
  /// Between what was felt and what was set.
  std::vector<PageSection> sections;
  /// Below the times that any session has.
  std::vector<MetricLine> further_times;
  /// More to say below a figure, by the figure's name without the mode ("force").
  std::map<std::string, std::string> caption_notes;
};

/// A mode's runs and the figures drawn from them, by what they show ("force").
struct DrawnGroup {
  RunGroup group;
  std::map<std::string, CaptionedFigure> figures;
};

/// The page report.html, what matters most first: the opening, the bone before and after, force, torque,
/// shaft and path, each with its figures and metrics, then what `text` adds, times, settings, and how to
/// repeat it. The figures are in the page itself. Throws InputError where a figure cannot be read.
std::string report_page(const std::vector<DrawnGroup>& groups, const PageText& text);

}  // namespace osteomill
