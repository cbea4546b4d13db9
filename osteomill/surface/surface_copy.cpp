#include "osteomill/surface/surface_copy.h"

#include <algorithm>
#include <numeric>

#include "osteomill/surface/brick_mesher.h"

namespace osteomill {

SurfaceCopy::SurfaceCopy(const Volume& volume)
    : grid_(volume.grid()),
      ranges_(volume.bricks()),
      isovalue_(volume.isovalue()),
      layout_(volume.geometry().dims),
      marked_(layout_.count(), 0),
      has_mesh_(layout_.count(), 0) {
  mark_all();
}

void SurfaceCopy::mark_all() {
  marked_.assign(layout_.count(), 1);
  to_mesh_.resize(layout_.count());
  std::iota(to_mesh_.begin(), to_mesh_.end(), std::size_t{0});
}

void SurfaceCopy::set_isovalue(double isovalue) {
  if (isovalue == isovalue_) return;
  isovalue_ = isovalue;
  mark_all();
}

void SurfaceCopy::put(const DensityHandover::Brick& brick) {
  constexpr int kSide = DensityHandover::kBrickVoxels;
  const std::array<int, 3>& dims = grid_.geometry().dims;
  const VoxelIndex& first = brick.first;
  const int count = std::min(kSide, dims[0] - first.i);
  std::array<int, kSide> columns;
  std::iota(columns.begin(), columns.end(), first.i);
  VoxelBox changed;
  for (int k = first.k; k < std::min(first.k + kSide, dims[2]); ++k) {
    for (int j = first.j; j < std::min(first.j + kSide, dims[1]); ++j) {
      const float* row =
          &brick.densities[static_cast<std::size_t>(kSide * (j - first.j + kSide * (k - first.k)))];
      if (std::equal(row, row + count, grid_.densities().data() + grid_.linear_index({first.i, j, k})))
        continue;
      for (int n = 0; n < count; ++n) grid_.set({first.i + n, j, k}, row[n]);
      ranges_.lower_row(j, k, columns.data(), row, static_cast<std::size_t>(count));
      changed.include({first.i, j, k});
      changed.include({first.i + count - 1, j, k});
    }
  }
  const VoxelBox bricks = layout_.touched_by(changed);
  for (int bk = bricks.first.k; bk <= bricks.last.k; ++bk) {
    for (int bj = bricks.first.j; bj <= bricks.last.j; ++bj) {
      for (int bi = bricks.first.i; bi <= bricks.last.i; ++bi) {
        const std::size_t number = layout_.index(bi, bj, bk);
        if (!marked_[number]) to_mesh_.push_back(number);
        marked_[number] = 1;
      }
    }
  }
}

std::vector<ChangedBrick> SurfaceCopy::remesh() {
  std::vector<ChangedBrick> changed;
  BrickMesher mesher(DensityView(grid_, ranges_, isovalue_));
  for (const std::size_t brick : to_mesh_) {
    marked_[brick] = 0;
    mesher.mesh(brick);
    const bool had_mesh = has_mesh_[brick] != 0;
    has_mesh_[brick] = !mesher.indices().empty();
    if (had_mesh || has_mesh_[brick]) changed.push_back({brick, mesher.copy()});
  }
  to_mesh_.clear();
  return changed;
}

}  // namespace osteomill
