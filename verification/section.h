#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "osteomill/base/distribution.h"

namespace osteomill::verification {

/// One table of docs/verification.md: what was measured, how, and whether it is what it must be.
struct Section {
  std::string title;
  /// Markdown: what must hold, and how it was measured.
  std::string about;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  /// The rows, by their first cell, that are not what they must be.
  std::vector<std::string> misses;
  /// The condition on its rows that the summary must name beside their number; empty for none.
  std::string reservation = {};

  /// Adds a row; a last cell says whether it holds.
  void add(std::vector<std::string> cells, bool holds);
  /// Adds a row of an algorithm: of ours as `add` does; those of the paper are reported, whatever they do.
  void add_of(std::string_view algorithm, std::vector<std::string> cells, bool holds);
};

/// The section as Markdown.
std::string to_markdown(const Section& section);

/// A number with three significant digits; "-" for what could not be measured.
std::string figure(double value);

/// "median (worst)" of figures that must be small.
std::string median_and_worst(std::vector<double> values);

}  // namespace osteomill::verification
