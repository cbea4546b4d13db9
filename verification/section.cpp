#include "verification/section.h"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>
#include <fmt/ranges.h>

#include "osteomill/haptics/algorithms.h"

namespace osteomill::verification {

void Section::add(std::vector<std::string> cells, bool holds) {
  if (!holds) misses.push_back(cells.front());
  cells.emplace_back(holds ? "holds" : "**misses**");
  rows.push_back(std::move(cells));
}

void Section::add_of(std::string_view algorithm, std::vector<std::string> cells, bool holds) {
  if (algorithm == default_algorithm().id) {
    add(std::move(cells), holds);
  } else {
    cells.emplace_back("reported");
    rows.push_back(std::move(cells));
  }
}

std::string to_markdown(const Section& section) {
  std::string text =
      fmt::format("## {}\n{}\n\n| {} |\n|", section.title, section.about, fmt::join(section.header, " | "));
  for (std::size_t n = 0; n < section.header.size(); ++n) text += "---|";
  text += "\n";
  for (const auto& row : section.rows) text += fmt::format("| {} |\n", fmt::join(row, " | "));
  return text + "\n";
}

std::string figure(double value) {
  return std::isnan(value) ? "-" : fmt::format("{:.3g}", value);
}

std::string median_and_worst(std::vector<double> values) {
  const Distribution d = distribution_of(std::move(values));
  return fmt::format("{} ({})", figure(d.median), figure(d.max));
}

}  // namespace osteomill::verification
