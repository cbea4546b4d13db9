#pragma once

#include <array>
#include <cstddef>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// The densities of 8 x 8 x 8 voxels, the pieces in which changes of the bone go from thread to thread.
struct DensityBlock {
  static constexpr int kVoxels = 8;

  /// The lowest voxel; the brick may reach beyond the grid, where its densities mean nothing.
  VoxelIndex first;
  VoxelIndex last() const { return {first.i + kVoxels - 1, first.j + kVoxels - 1, first.k + kVoxels - 1}; }
  /// Along i fastest.
  std::array<float, static_cast<std::size_t>(kVoxels* kVoxels* kVoxels)> densities;

  DensityBlock() = default;
  /// As the grid is now. Safe in the haptic tick.
  DensityBlock(const DensityGrid& grid, const VoxelIndex& first) noexcept;
};

/// Puts the brick's densities into the bone, and the bone's into the brick: a second call undoes the first.
/// Returns which voxels changed. Keeps the bone's brick ranges, exact again where a density rose. Not for the
/// tick.
VoxelBox swap_densities(Volume& bone, DensityBlock& brick);

}  // namespace osteomill
