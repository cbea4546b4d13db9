#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Keeps the least and greatest density in each brick of 8 x 8 x 8 voxels, each brick counted with one more
/// layer of voxels at its upper sides, so that it speaks of every trilinear cell that begins in it. Ranges
/// hold every density; after `lower_row` the upper end may be too wide until `refresh`.
class BlockRanges {
 public:
  static constexpr int kBrickVoxels = 8;
  /// The least and the greatest density of a brick.
  struct Range {
    float min;
    float max;
    /// Grows (and begins at 0 again after 2^32) whenever one of its densities is set again.
    std::uint32_t changes = 0;
  };

  BlockRanges() = default;
  explicit BlockRanges(const DensityGrid& grid);

  const std::array<int, 3>& dims() const { return dims_; }
  /// Returns the voxels that a brick counts, as far as they lie in the grid.
  static VoxelBox counted_voxels(const VoxelIndex& brick, const GridGeometry& geometry);
  /// Returns the range of the brick with these brick coordinates, counted from 0.
  const Range& at(int bi, int bj, int bk) const noexcept { return ranges_[row_major(dims_, bi, bj, bk)]; }
  const Range& at(const VoxelIndex& brick) const noexcept { return at(brick.i, brick.j, brick.k); }

  /// Returns a number that differs from the one returned before if the density of any of these voxels, all in
  /// the grid, was set since. Safe in the haptic tick.
  std::uint32_t changes_in(const VoxelBox& voxels) const noexcept;

  /// Takes in new, lower densities of `count` voxels of one row, whose columns ascend. Safe in the haptic
  /// tick.
  void lower_row(int j, int k, const int* columns, const float* densities, std::size_t count) noexcept;
  /// Makes the ranges of all bricks that touch `box` exact again.
  void refresh(const DensityGrid& grid, const VoxelBox& box);

 private:
  Range& range(const VoxelIndex& brick) { return ranges_[row_major(dims_, brick.i, brick.j, brick.k)]; }
  static Range range_of(const DensityGrid& grid, const VoxelIndex& brick);

  std::array<int, 3> dims_{0, 0, 0};
  std::vector<Range> ranges_;
};

}  // namespace osteomill
