#include "osteomill/volume/densities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace osteomill {

namespace {

constexpr int kStepsAway = 8;

std::optional<double> median(std::vector<float>& values) {
  if (values.empty()) return std::nullopt;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

// Takes every bone voxel to `visit`; bricks without bone are passed over.
template <typename Visit>
void for_each_bone_voxel(const Volume& volume, const Visit& visit) {
  constexpr int kSide = BlockRanges::kBrickVoxels;
  const BlockRanges& bricks = volume.bricks();
  for (int bk = 0; bk < bricks.dims()[2]; ++bk) {
    for (int bj = 0; bj < bricks.dims()[1]; ++bj) {
      for (int bi = 0; bi < bricks.dims()[0]; ++bi) {
        if (static_cast<double>(bricks.at(bi, bj, bk).max) <= volume.isovalue()) continue;
        const VoxelIndex first{bi * kSide, bj * kSide, bk * kSide};
        const VoxelBox box =
            VoxelBox{first, {first.i + kSide - 1, first.j + kSide - 1, first.k + kSide - 1}}.intersected(
                volume.geometry().all_voxels());
        for (int k = box.first.k; k <= box.last.k; ++k)
          for (int j = box.first.j; j <= box.last.j; ++j)
            for (int i = box.first.i; i <= box.last.i; ++i)
              if (volume.is_bone({i, j, k})) visit(VoxelIndex{i, j, k});
      }
    }
  }
}

// The density some steps out of the bone along an axis, where all voxels on the way are in the grid and not
// bone.
std::optional<float> density_away(const Volume& volume, const VoxelIndex& bone, std::size_t axis, int sign) {
  std::array<int, 3> v{bone.i, bone.j, bone.k};
  for (int step = 0; step < kStepsAway; ++step) {
    v[axis] += sign;
    const VoxelIndex here{v[0], v[1], v[2]};
    if (!volume.grid().contains(here) || volume.is_bone(here)) return std::nullopt;
  }
  return volume.grid()[{v[0], v[1], v[2]}];
}

double surroundings_without_a_surface(const Volume& volume) {
  std::vector<float> others;
  for (const float density : volume.grid().densities()) {
    if (static_cast<double>(density) < volume.isovalue()) others.push_back(density);
  }
  return median(others).value_or(volume.isovalue() - std::max(1.0, std::abs(volume.isovalue())));
}

}  // namespace

BoneDensities estimate_densities(const Volume& volume) {
  std::vector<float> bone;
  std::vector<float> around;
  for_each_bone_voxel(volume, [&](const VoxelIndex& v) {
    bone.push_back(volume.grid()[v]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (const int sign : {-1, 1}) {
        if (const std::optional<float> density = density_away(volume, v, axis, sign))
          around.push_back(*density);
      }
    }
  });
  BoneDensities densities;
  densities.surroundings = median(around).value_or(volume.isovalue());
  if (!(densities.surroundings < volume.isovalue())) {
    densities.surroundings = surroundings_without_a_surface(volume);
  }
  densities.reference = median(bone).value_or(2 * volume.isovalue() - densities.surroundings);
  return densities;
}

}  // namespace osteomill
