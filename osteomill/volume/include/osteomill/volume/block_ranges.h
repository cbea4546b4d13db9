#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Minimum and maximum density of each brick of 8 x 8 x 8 voxels. A brick includes one more layer of voxels
/// at its upper sides, so that its range bounds every trilinear cell that begins in it. Ranges are
/// conservative: after `lower_row` the maximum may be too high until `refresh`.
class BlockRanges {
 public:
  static constexpr int kBrickVoxels = 8;
  /// Minimum and maximum density of a brick.
  struct Range {
    float min;
    float max;
    /// Incremented whenever one of its densities is set; wraps around at 2^32.
    std::uint32_t changes = 0;
  };

  BlockRanges() = default;
  explicit BlockRanges(const DensityGrid& grid);

  const std::array<int, 3>& dims() const { return dims_; }
  /// Returns the voxels that a brick's range covers, clipped to the grid.
  static VoxelBox covered_voxels(const VoxelIndex& brick, const GridGeometry& geometry);
  /// Returns the range of the brick with these brick coordinates, from 0.
  const Range& at(int bi, int bj, int bk) const noexcept { return ranges_[row_major(dims_, bi, bj, bk)]; }
  const Range& at(const VoxelIndex& brick) const noexcept { return at(brick.i, brick.j, brick.k); }

  /// Returns a change counter for these voxels, all in the grid: it differs from an earlier result if any of
  /// their densities was set since. Safe in the haptic tick.
  std::uint32_t changes_in(const VoxelBox& voxels) const noexcept;

  /// Updates the ranges for new, lower densities of `count` voxels of one row, columns ascending. Safe in the
  /// haptic tick.
  void lower_row(int j, int k, const int* columns, const float* densities, std::size_t count) noexcept;
  /// Recomputes the exact ranges of all bricks that touch `box`.
  void refresh(const DensityGrid& grid, const VoxelBox& box);

 private:
  Range& range(const VoxelIndex& brick) { return ranges_[row_major(dims_, brick.i, brick.j, brick.k)]; }
  static Range range_of(const DensityGrid& grid, const VoxelIndex& brick);

  std::array<int, 3> dims_{0, 0, 0};
  std::vector<Range> ranges_;
};

}  // namespace osteomill
