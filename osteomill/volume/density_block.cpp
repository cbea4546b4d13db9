#include "osteomill/volume/density_block.h"

#include <algorithm>

namespace osteomill {

namespace {

VoxelIndex sides_within(const GridGeometry& geometry, const VoxelIndex& first) {
  constexpr int kSide = DensityBlock::kVoxels;
  return {std::min(kSide, geometry.dims[0] - first.i), std::min(kSide, geometry.dims[1] - first.j),
          std::min(kSide, geometry.dims[2] - first.k)};
}

std::size_t row_place(int j, int k) {
  return static_cast<std::size_t>(DensityBlock::kVoxels * (j + DensityBlock::kVoxels * k));
}

}  // namespace

DensityBlock::DensityBlock(const DensityGrid& grid, const VoxelIndex& first_) noexcept : first(first_) {
  const VoxelIndex sides = sides_within(grid.geometry(), first);
  if (sides != VoxelIndex{kVoxels, kVoxels, kVoxels}) densities.fill(0);
  for (int k = 0; k < sides.k; ++k) {
    for (int j = 0; j < sides.j; ++j) {
      const float* row = grid.densities().data() + grid.linear_index({first.i, first.j + j, first.k + k});
      std::copy_n(row, sides.i, &densities[row_place(j, k)]);
    }
  }
}

VoxelBox swap_densities(Volume& bone, DensityBlock& brick) {
  const VoxelIndex& first = brick.first;
  const VoxelIndex sides = sides_within(bone.geometry(), first);
  VoxelBox changed;
  VoxelBox risen;
  for (int k = 0; k < sides.k; ++k) {
    for (int j = 0; j < sides.j; ++j) {
      float* row = &brick.densities[row_place(j, k)];
      for (int i = 0; i < sides.i; ++i) {
        const VoxelIndex voxel{first.i + i, first.j + j, first.k + k};
        const float before = bone.grid()[voxel];
        if (before == row[i]) continue;
        changed.include(voxel);
        if (row[i] > before) risen.include(voxel);
        bone.set_density(voxel, row[i]);
        row[i] = before;
      }
    }
  }
  bone.refresh_bricks(risen);
  return changed;
}

std::vector<DensityBlock> differing_blocks(const DensityGrid& bone, const DensityGrid& scan) {
  constexpr int kSide = DensityBlock::kVoxels;
  const std::array<int, 3>& dims = scan.geometry().dims;
  std::vector<DensityBlock> blocks;
  for (int k = 0; k < dims[2]; k += kSide) {
    for (int j = 0; j < dims[1]; j += kSide) {
      for (int i = 0; i < dims[0]; i += kSide) {
        const DensityBlock block(bone, {i, j, k});
        if (block.densities != DensityBlock(scan, {i, j, k}).densities) blocks.push_back(block);
      }
    }
  }
  return blocks;
}

}  // namespace osteomill
