#include "osteomill/volume/density_block.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace osteomill {

namespace {

VoxelBox voxels_in_grid(const DensityBlock& block, const GridGeometry& geometry) {
  return VoxelBox{block.first, block.last()}.intersected(geometry.all_voxels());
}

std::size_t place_in(const DensityBlock& block, const VoxelIndex& v) {
  constexpr int kSide = DensityBlock::kVoxels;
  return row_major({kSide, kSide, kSide}, v.i - block.first.i, v.j - block.first.j, v.k - block.first.k);
}

}  // namespace

DensityBlock::DensityBlock(const DensityGrid& grid, const VoxelIndex& first_) noexcept : first(first_) {
  const VoxelBox inside = voxels_in_grid(*this, grid.geometry());
  if (inside.last != last()) densities.fill(0);
  for (int k = first.k; k <= inside.last.k; ++k) {
    for (int j = first.j; j <= inside.last.j; ++j) {
      const VoxelIndex row{first.i, j, k};
      std::copy_n(grid.address_of(row), inside.last.i - first.i + 1, &densities[place_in(*this, row)]);
    }
  }
}

VoxelBox swap_densities(Volume& bone, DensityBlock& brick) {
  const VoxelBox inside = voxels_in_grid(brick, bone.geometry());
  VoxelBox changed;
  VoxelBox risen;
  std::array<int, DensityBlock::kVoxels> columns;
  std::array<float, DensityBlock::kVoxels> densities;
  for (int k = inside.first.k; k <= inside.last.k; ++k) {
    for (int j = inside.first.j; j <= inside.last.j; ++j) {
      float* kept = &brick.densities[place_in(brick, {inside.first.i, j, k})];
      const float* before = bone.grid().address_of({inside.first.i, j, k});
      const auto length = static_cast<std::size_t>(inside.last.i - inside.first.i + 1);
      if (std::memcmp(kept, before, length * sizeof(float)) == 0) continue;
      std::size_t count = 0;
      for (int i = inside.first.i; i <= inside.last.i; ++i, ++kept, ++before) {
        if (*before == *kept) continue;
        changed.include({i, j, k});
        if (*kept > *before) risen.include({i, j, k});
        columns[count] = i;
        densities[count++] = std::exchange(*kept, *before);
      }
      if (count > 0) bone.lower_row(j, k, columns.data(), densities.data(), count);
    }
  }
  bone.refresh_ranges(risen);
  return changed;
}

}  // namespace osteomill
