#include "osteomill/experiment/paper.h"

#include <algorithm>

namespace osteomill {

namespace {

template <std::size_t N>
std::size_t place_in(const std::array<std::string_view, N>& names, std::string_view name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

std::size_t phase_number(std::string_view phase) {
  return place_in(kPhases, phase);
}

std::optional<double> paper_mean_rate_hz(std::string_view algorithm, std::string_view phase) {
  constexpr double kRates_hz[kPapersAlgorithms.size()][kPhases.size()] = {{976, 988}, {955, 963}, {973, 989}};
  const std::size_t row = place_in(kPapersAlgorithms, algorithm);
  const std::size_t column = phase_number(phase);
  if (row == kPapersAlgorithms.size() || column == kPhases.size()) return std::nullopt;
  return kRates_hz[row][column];
}

}  // namespace osteomill
