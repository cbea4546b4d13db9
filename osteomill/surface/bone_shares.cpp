#include "osteomill/surface/bone_shares.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "osteomill/numbers/row_major.h"
#include "osteomill/volume/densities.h"

namespace osteomill {

namespace {

constexpr std::size_t kLevels = 6;

std::array<int, 3> half_dims(const std::array<int, 3>& dims) {
  return {(dims[0] + 1) / 2, (dims[1] + 1) / 2, (dims[2] + 1) / 2};
}

}  // namespace

BoneShares::BoneShares(const Volume& volume)
    : geometry_(volume.geometry()), spacing_mm_(std::cbrt(volume.geometry().voxel_volume_mm3())) {
  levels_.push_back(finest(volume));
  while (levels_.size() < kLevels) levels_.push_back(halved(levels_.back()));
}

// Cells of two voxels already: finer ones would cost eight times the memory and show in no picture.
BoneShares::Level BoneShares::finest(const Volume& volume) {
  const auto& dims = volume.geometry().dims;
  Level level;
  level.dims = half_dims(dims);
  level.shares.assign(cell_count(level.dims), 0.0f);
  // A soft step from the surroundings to as far above the isovalue: a hard one would show the voxels as
  // terraces.
  const double surroundings = estimate_densities(volume).surroundings;
  const float foot = static_cast<float>(surroundings);
  const float per_density = static_cast<float>(0.5 / (volume.isovalue() - surroundings));
  const float* density = volume.grid().densities().data();
  for (int k = 0; k < dims[2]; ++k) {
    for (int j = 0; j < dims[1]; ++j) {
      float* row = level.shares.data() + row_major(level.dims, 0, j / 2, k / 2);
      for (int i = 0; i < dims[0]; ++i, ++density) {
        row[i / 2] += 0.125f * std::clamp((*density - foot) * per_density, 0.0f, 1.0f);
      }
    }
  }
  return level;
}

BoneShares::Level BoneShares::halved(const Level& finer) {
  Level level;
  level.dims = half_dims(finer.dims);
  level.shares.assign(cell_count(level.dims), 0.0f);
  const float* share = finer.shares.data();
  for (int k = 0; k < finer.dims[2]; ++k) {
    for (int j = 0; j < finer.dims[1]; ++j) {
      float* row = level.shares.data() + row_major(level.dims, 0, j / 2, k / 2);
      for (int i = 0; i < finer.dims[0]; ++i, ++share) row[i / 2] += 0.125f * *share;
    }
  }
  return level;
}

double BoneShares::Level::at(int i, int j, int k) const {
  if (i < 0 || j < 0 || k < 0 || i >= dims[0] || j >= dims[1] || k >= dims[2]) return 0;
  return static_cast<double>(shares[row_major(dims, i, j, k)]);
}

double BoneShares::Level::interpolated(const Vec3& cell) const {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(cell[axis] > -1 && cell[axis] < dims[static_cast<std::size_t>(axis)])) return 0;
  }
  // Truncation rounds down what is not below 0.
  const int i = static_cast<int>(cell.x() + 1) - 1;
  const int j = static_cast<int>(cell.y() + 1) - 1;
  const int k = static_cast<int>(cell.z() + 1) - 1;
  const Vec3 f = cell - Vec3(i, j, k);
  const bool interior = i >= 0 && j >= 0 && k >= 0 && i + 1 < dims[0] && j + 1 < dims[1] && k + 1 < dims[2];
  const auto row = [&](int dj, int dk) {
    if (!interior) return at(i, j + dj, k + dk) * (1 - f.x()) + at(i + 1, j + dj, k + dk) * f.x();
    const float* share = shares.data() + row_major(dims, i, j + dj, k + dk);
    return static_cast<double>(share[0]) * (1 - f.x()) + static_cast<double>(share[1]) * f.x();
  };
  return (row(0, 0) * (1 - f.y()) + row(1, 0) * f.y()) * (1 - f.z()) +
         (row(0, 1) * (1 - f.y()) + row(1, 1) * f.y()) * f.z();
}

double BoneShares::around(const Vec3& point_W, double width_mm) const {
  std::size_t level = 0;
  double voxels = 2;
  while (level + 1 < levels_.size() && 1.41 * voxels * spacing_mm_ < width_mm) {
    ++level;
    voxels *= 2;
  }
  const Vec3 voxel = geometry_.voxel_from_world(point_W);
  return levels_[level].interpolated((voxel.array() + 0.5) / voxels - 0.5);
}

double BoneShares::clear_share(const Vec3& apex_W, const Vec3& direction_W, double width_per_mm,
                               double reach_mm) const {
  double clear = 1;
  double away_mm = 2 * spacing_mm_;
  while (away_mm < reach_mm && clear > 0.02) {
    const double width_mm = std::max(2 * spacing_mm_, width_per_mm * away_mm);
    const double fade = 1 - away_mm / reach_mm;
    clear *= 1 - fade * around(apex_W + away_mm * direction_W, width_mm);
    away_mm += 0.7 * width_mm;
  }
  return clear;
}

}  // namespace osteomill
