#include "osteomill/surface/surface_copy.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "osteomill/surface/brick_mesher.h"

namespace osteomill {

static_assert(DensityHandover::kBrickVoxels == BrickRanges::kBrickVoxels);

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
  mark(layout_.touched_by(take_over(brick)));
}

// Answers which voxels changed.
VoxelBox SurfaceCopy::take_over(const DensityHandover::Brick& brick) {
  constexpr int kSide = DensityHandover::kBrickVoxels;
  const std::array<int, 3>& dims = grid_.geometry().dims;
  const VoxelIndex& first = brick.first;
  const int columns = std::min(kSide, dims[0] - first.i);
  VoxelBox changed;
  float least = std::numeric_limits<float>::max();
  for (int k = first.k; k < std::min(first.k + kSide, dims[2]); ++k) {
    for (int j = first.j; j < std::min(first.j + kSide, dims[1]); ++j) {
      const float* row =
          &brick.densities[static_cast<std::size_t>(kSide * (j - first.j + kSide * (k - first.k)))];
      for (int n = 0; n < columns; ++n) {
        const VoxelIndex voxel{first.i + n, j, k};
        if (grid_[voxel] == row[n]) continue;
        grid_.set(voxel, row[n]);
        changed.include(voxel);
        least = std::min(least, row[n]);
      }
    }
  }
  // By the brick's first voxel, which also stands for the bricks before it: their ranges come out wider than
  // they are, never narrower.
  if (!changed.empty()) ranges_.lower(first, least);
  return changed;
}

void SurfaceCopy::mark(const VoxelBox& bricks) {
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
