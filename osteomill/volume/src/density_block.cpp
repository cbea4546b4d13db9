#include "osteomill/volume/density_block.h"

#include <algorithm>

namespace osteomill {

DensityBlock::DensityBlock(const DensityGrid& grid, const VoxelIndex& first_) noexcept : first(first_) {
  const VoxelBox inside = voxels_in(grid.geometry());
  if (inside.last != last()) densities.fill(0);
  for (int k = first.k; k <= inside.last.k; ++k) {
    for (int j = first.j; j <= inside.last.j; ++j) {
      const VoxelIndex row{first.i, j, k};
      std::copy_n(grid.address_of(row), inside.last.i - first.i + 1, &densities[index_of(row)]);
    }
  }
}

std::vector<DensityBlock> differing_blocks(const DensityGrid& bone, const DensityGrid& scan) {
  constexpr int kSide = DensityBlock::kVoxels;
  std::vector<DensityBlock> blocks;
  for_each(scan.geometry().all_voxels().bricks(kSide), [&](const VoxelIndex& brick) {
    const VoxelIndex first = VoxelBox::of_brick(brick, kSide).first;
    const DensityBlock block(bone, first);
    if (block.densities != DensityBlock(scan, first).densities) blocks.push_back(block);
  });
  return blocks;
}

}  // namespace osteomill
