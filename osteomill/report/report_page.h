#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "osteomill/report/figure.h"
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
  /// Plain text at the page's top.
  std::string in_short;
  /// A paragraph of plain text after what was run.
  std::string what_was_done;
  /// HTML after that.
  std::string sections;
  /// HTML at the head of a mode's runs.
  std::function<std::string(const RunGroup&)> about_group;
  /// Below the metrics that any session has.
  std::vector<MetricLine> further_metrics;
  /// More to say below a figure, by the figure's name without the mode ("force").
  std::map<std::string, std::string> caption_notes;
};

struct CaptionedFigure {
  Figure files;
  std::string caption;
};

/// A mode's runs and the figures drawn from them.
struct DrawnGroup {
  RunGroup group;
  std::vector<CaptionedFigure> figures;
};

/// A paragraph of plain text, as HTML.
std::string html_paragraph(const std::string& text);

/// The page report.html: what was run, all figures and tables, the settings, and how to repeat it, with what
/// `text` adds. The figures are in the page itself. Throws InputError where a figure cannot be read.
std::string report_page(const std::vector<DrawnGroup>& groups, const PageText& text);

}  // namespace osteomill
