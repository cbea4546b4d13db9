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

}  // namespace osteomill
