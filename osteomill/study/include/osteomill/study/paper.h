#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

namespace osteomill {

/// The two parts of the test of section 8.2, as the phases of its recordings are named, in their order.
inline constexpr std::string_view kMilling = "milling";
inline constexpr std::string_view kHolding = "holding";
inline constexpr std::array<std::string_view, 2> kPhases{kMilling, kHolding};

/// The place of a phase in that order; of any other phase the one after the last.
inline std::size_t phase_number(std::string_view phase) {
  return static_cast<std::size_t>(std::ranges::find(kPhases, phase) - kPhases.begin());
}

/// The algorithms that the paper compares, in its order.
inline constexpr std::array<std::string_view, 3> kPapersAlgorithms{"line-proxy", "surface-points",
                                                                   "point-shell"};

}  // namespace osteomill
