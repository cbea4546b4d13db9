#include "osteomill/volume/block_ranges.h"

#include <algorithm>

namespace osteomill {

namespace {

// First brick along an axis whose range includes voxel coordinate `v`: its own, or the one below if that
// counts `v` as its extra layer.
int first_counting(int v) {
  const int own = v / BlockRanges::kBrickVoxels;
  return v % BlockRanges::kBrickVoxels == 0 && own > 0 ? own - 1 : own;
}

VoxelBox bricks_counting(const VoxelBox& voxels) {
  return {{first_counting(voxels.first.i), first_counting(voxels.first.j), first_counting(voxels.first.k)},
          voxels.bricks(BlockRanges::kBrickVoxels).last};
}

void widen(BlockRanges::Range& range, float lower_density) {
  range.min = std::min(range.min, lower_density);
  ++range.changes;
}

}  // namespace

BlockRanges::BlockRanges(const DensityGrid& grid)
    : dims_(grid.geometry().all_voxels().bricks(kBrickVoxels).dims()) {
  ranges_.resize(cell_count(dims_));
  for_each_with_progress(grid.geometry().all_voxels().bricks(kBrickVoxels),
                         [&](const VoxelIndex& brick) { range(brick) = range_of(grid, brick); });
}

VoxelBox BlockRanges::covered_voxels(const VoxelIndex& brick, const GridGeometry& geometry) {
  const auto& [i, j, k] = VoxelBox::of_brick(brick, kBrickVoxels).last;
  return VoxelBox{VoxelBox::of_brick(brick, kBrickVoxels).first, {i + 1, j + 1, k + 1}}.intersected(
      geometry.all_voxels());
}

BlockRanges::Range BlockRanges::range_of(const DensityGrid& grid, const VoxelIndex& brick) {
  const VoxelBox box = covered_voxels(brick, grid.geometry());
  Range range{grid[box.first], grid[box.first]};
  for (int k = box.first.k; k <= box.last.k; ++k) {
    for (int j = box.first.j; j <= box.last.j; ++j) {
      const float* row = grid.address_of({box.first.i, j, k});
      const auto [min, max] = std::minmax_element(row, row + (box.last.i - box.first.i + 1));
      range.min = std::min(range.min, *min);
      range.max = std::max(range.max, *max);
    }
  }
  return range;
}

std::uint32_t BlockRanges::changes_in(const VoxelBox& voxels) const noexcept {
  std::uint32_t changes = 0;
  for_each(voxels.bricks(kBrickVoxels), [&](const VoxelIndex& brick) { changes += at(brick).changes; });
  return changes;
}

void BlockRanges::lower_row(int j, int k, const int* columns, const float* densities,
                            std::size_t count) noexcept {
  const auto [first, last] = bricks_counting({{0, j, k}, {0, j, k}});
  const auto lower_column = [first = first, last = last, this](int bi, float density) {
    for (int bk = first.k; bk <= last.k; ++bk) {
      for (int bj = first.j; bj <= last.j; ++bj) widen(range({bi, bj, bk}), density);
    }
  };
  for (std::size_t n = 0; n < count;) {
    const int bi = columns[n] / kBrickVoxels;
    if (columns[n] % kBrickVoxels == 0 && bi > 0) lower_column(bi - 1, densities[n]);
    float min = densities[n];
    for (++n; n < count && columns[n] < (bi + 1) * kBrickVoxels; ++n) min = std::min(min, densities[n]);
    lower_column(bi, min);
  }
}

void BlockRanges::refresh(const DensityGrid& grid, const VoxelBox& box) {
  const VoxelBox inside = box.intersected(grid.geometry().all_voxels());
  if (inside.empty()) return;
  for_each(bricks_counting(inside), [&](const VoxelIndex& brick) {
    const std::uint32_t changes = range(brick).changes + 1;
    range(brick) = range_of(grid, brick);
    range(brick).changes = changes;
  });
}

}  // namespace osteomill
