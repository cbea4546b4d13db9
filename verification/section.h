#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "osteomill/base/distribution.h"

namespace osteomill::verification {

/// One table of docs/verification.md, with its description and the rows that miss.
struct Section {
  std::string title;
  /// Conditions that must hold, and the method of measurement, in Markdown.
  std::string about;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  /// First cells of the rows that miss.
  std::vector<std::string> misses;
  /// Reservation that the summary prints after the number of rows; empty if there is none.
  std::string reservation = {};

  /// Adds a row, with its verdict as an additional last cell.
  void add(std::vector<std::string> cells, bool holds);
  /// Adds a row of an algorithm. Rows of the default algorithm are judged as by `add`; others are only
  /// reported.
  void add_of(std::string_view algorithm, std::vector<std::string> cells, bool holds);
};

/// Returns the section as Markdown.
std::string to_markdown(const Section& section);

/// Returns the number with three significant digits, or "-" for NaN.
std::string figure(double value);

/// Returns "median (worst)", for figures of which smaller is better.
std::string median_and_worst(std::vector<double> values);

}  // namespace osteomill::verification
