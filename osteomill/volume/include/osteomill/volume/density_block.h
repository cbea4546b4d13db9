#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// The densities of a brick of 8 x 8 x 8 voxels, the piece in which changes of the bone go from thread to
/// thread. (Ranges, surface and bone points have bricks of their own.)
struct DensityBlock {
  static constexpr int kVoxels = 8;

  /// The lowest voxel. The brick may reach beyond the grid; its densities there mean nothing.
  VoxelIndex first;
  VoxelIndex last() const { return {first.i + kVoxels - 1, first.j + kVoxels - 1, first.k + kVoxels - 1}; }
  /// The densities in row-major order, i fastest.
  std::array<float, static_cast<std::size_t>(kVoxels* kVoxels* kVoxels)> densities;

  /// Returns its voxels that lie in the grid.
  VoxelBox voxels_in(const GridGeometry& geometry) const {
    return VoxelBox{first, last()}.intersected(geometry.all_voxels());
  }
  /// Returns where among `densities` that of voxel `v` is.
  std::size_t index_of(const VoxelIndex& v) const {
    return row_major({kVoxels, kVoxels, kVoxels}, v.i - first.i, v.j - first.j, v.k - first.k);
  }

  DensityBlock() = default;
  /// Copies the grid's densities as they are now, from voxel `first` on. Safe in the haptic tick.
  DensityBlock(const DensityGrid& grid, const VoxelIndex& first) noexcept;
};

/// Returns the bricks of `bone` in which any density differs from that of `scan`, on the same grid. Goes
/// through every voxel; not for the tick.
std::vector<DensityBlock> differing_blocks(const DensityGrid& bone, const DensityGrid& scan);

}  // namespace osteomill
