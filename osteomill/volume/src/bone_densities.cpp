#include "osteomill/volume/bone_densities.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

constexpr int kStepsAway = 8;

// Maps a float to an integer of the same order.
std::uint32_t rank_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value);
  return (bits >> 31) != 0 ? ~bits : bits | 1u << 31;
}

// Returns the median of the values that `for_each` passes to its argument. Calls it twice, with the same
// values each time: the first pass counts by the upper 16 bits of the ranks, the second by the lower 16 bits
// of the ranks in the median's bin. This avoids storing up to a billion values.
template <typename ForEach>
std::optional<double> median(const ForEach& for_each) {
  std::vector<std::size_t> counts(1 << 16);
  std::size_t all = 0;
  {
    const WorkProgress::Part first(0.5);
    for_each([&](float value) {
      ++counts[rank_of(value) >> 16];
      ++all;
    });
  }
  if (all == 0) return std::nullopt;
  std::size_t before = all / 2;
  // Finds the bin that holds the median; leaves in `before` the number of its values below the median.
  const auto find = [&] {
    std::uint32_t half = 0;
    for (; before >= counts[half]; ++half) before -= counts[half];
    return half;
  };
  const std::uint32_t upper = find();
  counts.assign(counts.size(), 0);
  const WorkProgress::Part second(1);
  for_each([&](float value) {
    if (const std::uint32_t rank = rank_of(value); rank >> 16 == upper) ++counts[rank & 0xffff];
  });
  const std::uint32_t rank = upper << 16 | find();
  return static_cast<double>(std::bit_cast<float>((rank >> 31) != 0 ? rank & ~(1u << 31) : ~rank));
}

// Density kStepsAway steps along an axis, if all voxels on the way are in the grid and not bone.
std::optional<float> density_away(const Volume& volume, const VoxelIndex& bone, std::size_t axis, int sign) {
  std::array<int, 3> v{bone.i, bone.j, bone.k};
  for (int step = 0; step < kStepsAway; ++step) {
    v[axis] += sign;
    const VoxelIndex here{v[0], v[1], v[2]};
    if (!volume.grid().contains(here) || volume.is_bone(here)) return std::nullopt;
  }
  const VoxelIndex away{v[0], v[1], v[2]};
  if (!volume.grid().has_density(volume.grid().linear_index(away))) return std::nullopt;
  return volume.grid()[away];
}

// Returns the median density of the voxels that density_away() finds around the bone.
std::optional<double> median_around(const Volume& volume) {
  std::vector<float> around;
  {
    const WorkProgress::Part looking(0.9);
    for_each_bone_voxel(volume, [&](const VoxelIndex& v) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const int sign : {-1, 1}) {
          if (const std::optional<float> density = density_away(volume, v, axis, sign))
            around.push_back(*density);
        }
      }
    });
  }
  const WorkProgress::Part counting(1);
  return median([&](const auto& take) { std::for_each(around.begin(), around.end(), take); });
}

double surroundings_without_a_surface(const Volume& volume) {
  const std::optional<double> others = median([&](const auto& take) {
    for_each_density(volume.grid(), [&](float density) {
      if (static_cast<double>(density) < volume.isovalue()) take(density);
    });
  });
  return others.value_or(volume.isovalue() - std::max(1.0, std::abs(volume.isovalue())));
}

}  // namespace

BoneDensities estimate_densities(const Volume& volume) {
  BoneDensities densities;
  {
    const WorkProgress::Part around(0.5);
    densities.surroundings = median_around(volume).value_or(volume.isovalue());
    if (!(densities.surroundings < volume.isovalue())) {
      densities.surroundings = surroundings_without_a_surface(volume);
    }
  }
  const WorkProgress::Part bone(1);
  densities.reference = median([&](const auto& take) {
                          for_each_bone_voxel(volume, [&](const VoxelIndex& v) { take(volume.grid()[v]); });
                        }).value_or(2 * volume.isovalue() - densities.surroundings);
  return densities;
}

}  // namespace osteomill
