#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// Densities of a brick of 8 x 8 x 8 voxels, the unit in which bone changes are passed between threads. (Not
/// the bricks of BlockRanges, of the surface or of the bone points.)
struct DensityBlock {
  static constexpr int kVoxels = 8;

  /// Lowest voxel. The brick may extend beyond the grid; its densities there are meaningless.
  VoxelIndex first;
  VoxelIndex last() const { return {first.i + kVoxels - 1, first.j + kVoxels - 1, first.k + kVoxels - 1}; }
  /// Densities in row-major order, i fastest.
  std::array<float, static_cast<std::size_t>(kVoxels* kVoxels* kVoxels)> densities;

  /// Returns its voxels that lie in the grid.
  VoxelBox voxels_in(const GridGeometry& geometry) const {
    return VoxelBox{first, last()}.intersected(geometry.all_voxels());
  }
  /// Returns the index of voxel `v` in `densities`.
  std::size_t index_of(const VoxelIndex& v) const {
    return row_major({kVoxels, kVoxels, kVoxels}, v.i - first.i, v.j - first.j, v.k - first.k);
  }

  DensityBlock() = default;
  /// Copies the grid's current densities, from voxel `first` on. Safe in the haptic tick.
  DensityBlock(const DensityGrid& grid, const VoxelIndex& first) noexcept;
};

/// Returns the bricks of `bone` in which any density differs from `scan`, which has the same grid. Passes
/// over the voxels; not for the tick.
std::vector<DensityBlock> differing_blocks(const DensityGrid& bone, const DensityGrid& scan);

}  // namespace osteomill
