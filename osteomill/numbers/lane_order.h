#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace osteomill {

/// For each choice of up to 8 lanes, a bit each: those that are chosen first, then the others.
inline constexpr auto kLaneOrder = [] {
  constexpr int kLanes = 8;
  std::array<std::array<std::int32_t, kLanes>, 1u << kLanes> orders{};
  for (std::size_t bits = 0; bits < orders.size(); ++bits) {
    std::size_t n = 0;
    for (const std::size_t chosen : {std::size_t{1}, std::size_t{0}}) {
      for (int lane = 0; lane < kLanes; ++lane) {
        if ((bits >> lane & 1) == chosen) orders[bits][n++] = lane;
      }
    }
  }
  return orders;
}();

}  // namespace osteomill
