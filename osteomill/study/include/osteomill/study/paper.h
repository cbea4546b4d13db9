#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace osteomill {

/// Phase name of a recording of the first part of the test of section 8.2.
inline constexpr std::string_view kMilling = "milling";
/// Phase name of a recording of the second part.
inline constexpr std::string_view kHolding = "holding";
/// Both phases in their order.
inline constexpr std::array<std::string_view, 2> kPhases{kMilling, kHolding};

/// Returns the index of a phase in kPhases; kPhases.size() for any other phase.
inline std::size_t phase_index(std::string_view phase) {
  return static_cast<std::size_t>(std::ranges::find(kPhases, phase) - kPhases.begin());
}

/// The algorithms that the paper compares, in its order.
inline constexpr std::array<std::string_view, 3> kPapersAlgorithms{"line-proxy", "surface-points",
                                                                   "point-shell"};

}  // namespace osteomill
