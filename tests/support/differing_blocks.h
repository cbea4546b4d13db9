#pragma once

#include <vector>

#include "osteomill/volume/density_block.h"

namespace osteomill {

/// For tests. Those of `bone` in which any density differs from that of `scan`, on the same grid. Goes
/// through both.
inline std::vector<DensityBlock> differing_blocks(const DensityGrid& bone, const DensityGrid& scan) {
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
