#include "osteomill/volume/densities.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

constexpr int kStepsAway = 8;

// Grows with the number.
std::uint32_t rank_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits >> 31) != 0 ? ~bits : bits | 1u << 31;
}

// By counting how often the upper and then the lower half of the rank is which: there may be a hundred
// million.
std::optional<double> median(const std::vector<float>& values) {
  if (values.empty()) return std::nullopt;
  std::size_t before = values.size() / 2;
  std::uint32_t upper = 0;
  std::vector<std::size_t> counts;
  // How many of those `half` says are which; returns the one in which the wanted one lies.
  const auto find = [&](const auto& half) {
    counts.assign(1 << 16, 0);
    constexpr std::size_t kAtOnce = 1 << 22;
    for (std::size_t first = 0; first < values.size(); first += kAtOnce) {
      const std::size_t last = std::min(first + kAtOnce, values.size());
      for (std::size_t n = first; n < last; ++n) half(rank_of(values[n]));
      WorkProgress::done(1);
    }
    std::uint32_t place = 0;
    for (; before >= counts[place]; ++place) before -= counts[place];
    return place;
  };
  upper = find([&](std::uint32_t rank) { ++counts[rank >> 16]; });
  const std::uint32_t lower = find([&](std::uint32_t rank) {
    if (rank >> 16 == upper) ++counts[rank & 0xffff];
  });
  const std::uint32_t rank = upper << 16 | lower;
  return static_cast<double>(std::bit_cast<float>((rank >> 31) != 0 ? rank & ~(1u << 31) : ~rank));
}

// Takes every bone voxel to `visit`; bricks without bone are passed over.
template <typename Visit>
void for_each_bone_voxel(const Volume& volume, const Visit& visit) {
  constexpr int kSide = BlockRanges::kBrickVoxels;
  const BlockRanges& bricks = volume.bricks();
  for (int bk = 0; bk < bricks.dims()[2]; ++bk) {
    WorkProgress::done(static_cast<std::size_t>(bk), static_cast<std::size_t>(bricks.dims()[2]));
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
