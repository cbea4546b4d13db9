#pragma once

#include <string>
#include <vector>

#include "osteomill/report/figure.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

struct CaptionedFigure {
  Figure files;
  std::string caption;
};

/// A mode's runs and the figures drawn from them.
struct DrawnGroup {
  RunGroup group;
  std::vector<CaptionedFigure> figures;
};

/// What a page may have beside its recordings.
struct PageAdditions {
  /// Plain text at the page's top; empty for none.
  std::string in_short;
  /// HTML after what was run.
  std::string sections;
};

/// The page report.html: what was run, what came of it in plain words, the paper's findings held against it,
/// all figures and tables, the settings, and how to repeat it. The figures are in the page itself. Throws
/// InputError where a figure cannot be read.
std::string report_page(const std::vector<DrawnGroup>& groups, const PageAdditions& additions = {});

}  // namespace osteomill
