#pragma once

#include <array>
#include <cstddef>

namespace osteomill {

/// Returns the number of cells in a box of `dims` cells.
constexpr std::size_t cell_count(const std::array<int, 3>& dims) noexcept {
  return static_cast<std::size_t>(dims[0]) * static_cast<std::size_t>(dims[1]) *
         static_cast<std::size_t>(dims[2]);
}

/// Returns the linear index of cell (i, j, k), which must lie in the box; i varies fastest, k slowest. All
/// arrays of voxels, bricks and nodes in osteomill use this order. Safe in the haptic tick.
constexpr std::size_t row_major(const std::array<int, 3>& dims, int i, int j, int k) noexcept {
  return static_cast<std::size_t>(i) +
         static_cast<std::size_t>(dims[0]) *
             (static_cast<std::size_t>(j) + static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(k));
}

/// Returns the cell (i, j, k) at a linear index.
constexpr std::array<int, 3> cell_at(const std::array<int, 3>& dims, std::size_t index) noexcept {
  const auto columns = static_cast<std::size_t>(dims[0]), rows = static_cast<std::size_t>(dims[1]);
  return {static_cast<int>(index % columns), static_cast<int>(index / columns % rows),
          static_cast<int>(index / columns / rows)};
}

}  // namespace osteomill
