#include "osteomill/volume/block_ranges.h"

#include <algorithm>

#include "osteomill/numbers/row_major.h"
#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

// The bricks whose range counts voxel coordinate `v`: its own, and the one below where `v` is the layer
// between.
struct BrickSpan {
  int first;
  int last;
};

BrickSpan bricks_counting(int v) {
  const int own = v / BlockRanges::kBrickVoxels;
  return {v % BlockRanges::kBrickVoxels == 0 && own > 0 ? own - 1 : own, own};
}

}  // namespace

BlockRanges::BlockRanges(const DensityGrid& grid) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    dims_[axis] = (grid.geometry().dims[axis] + kBrickVoxels - 1) / kBrickVoxels;
  }
  ranges_.resize(cell_count(dims_));
  for (int bk = 0; bk < dims_[2]; ++bk) {
    for (int bj = 0; bj < dims_[1]; ++bj) {
      for (int bi = 0; bi < dims_[0]; ++bi) ranges_[index(bi, bj, bk)] = range_of(grid, bi, bj, bk);
    }
    WorkProgress::done(static_cast<std::size_t>(bk), static_cast<std::size_t>(dims_[2]));
  }
}

BlockRanges::Range BlockRanges::range_of(const DensityGrid& grid, int bi, int bj, int bk) {
  const VoxelIndex first{bi * kBrickVoxels, bj * kBrickVoxels, bk * kBrickVoxels};
  const VoxelBox box =
      VoxelBox{first, {first.i + kBrickVoxels, first.j + kBrickVoxels, first.k + kBrickVoxels}}.intersected(
          grid.geometry().all_voxels());
  Range range{grid[first], grid[first]};
  for (int k = box.first.k; k <= box.last.k; ++k) {
    for (int j = box.first.j; j <= box.last.j; ++j) {
      const float* row = grid.densities().data() + grid.linear_index({box.first.i, j, k});
      const auto [min, max] = std::minmax_element(row, row + (box.last.i - box.first.i + 1));
      range.min = std::min(range.min, *min);
      range.max = std::max(range.max, *max);
    }
  }
  return range;
}

std::uint32_t BlockRanges::changes_in(const VoxelBox& voxels) const {
  constexpr int n = kBrickVoxels;
  std::uint32_t changes = 0;
  for (int bk = voxels.first.k / n; bk <= voxels.last.k / n; ++bk) {
    for (int bj = voxels.first.j / n; bj <= voxels.last.j / n; ++bj) {
      for (int bi = voxels.first.i / n; bi <= voxels.last.i / n; ++bi) changes += at(bi, bj, bk).changes;
    }
  }
  return changes;
}

void BlockRanges::lower_brick(int bi, int bj, int bk, float density) {
  Range& range = ranges_[index(bi, bj, bk)];
  range.min = std::min(range.min, density);
  ++range.changes;
}

void BlockRanges::lower(const VoxelIndex& v, float density) {
  const BrickSpan spans[3] = {bricks_counting(v.i), bricks_counting(v.j), bricks_counting(v.k)};
  for (int bk = spans[2].first; bk <= spans[2].last; ++bk) {
    for (int bj = spans[1].first; bj <= spans[1].last; ++bj) {
      for (int bi = spans[0].first; bi <= spans[0].last; ++bi) lower_brick(bi, bj, bk, density);
    }
  }
}

void BlockRanges::lower_row(int j, int k, const int* columns, const float* densities, std::size_t count) {
  const BrickSpan js = bricks_counting(j);
  const BrickSpan ks = bricks_counting(k);
  const auto lower_column = [&](int bi, float density) {
    for (int bk = ks.first; bk <= ks.last; ++bk) {
      for (int bj = js.first; bj <= js.last; ++bj) lower_brick(bi, bj, bk, density);
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
  for (int bk = bricks_counting(inside.first.k).first; bk <= inside.last.k / kBrickVoxels; ++bk) {
    for (int bj = bricks_counting(inside.first.j).first; bj <= inside.last.j / kBrickVoxels; ++bj) {
      for (int bi = bricks_counting(inside.first.i).first; bi <= inside.last.i / kBrickVoxels; ++bi) {
        Range& range = ranges_[index(bi, bj, bk)];
        const std::uint32_t changes = range.changes + 1;
        range = range_of(grid, bi, bj, bk);
        range.changes = changes;
      }
    }
  }
}

}  // namespace osteomill
