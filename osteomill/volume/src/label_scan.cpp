#include "osteomill/volume/label_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "osteomill/base/work_progress.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

namespace {

constexpr int kGreatestLabel = std::numeric_limits<std::int16_t>::max();

// Returns by label its rank among those that occur; nothing unless the values are few whole numbers and 0 is
// the commonest.
std::vector<int> ranks_of(const DensityGrid& grid) {
  std::vector<std::size_t> counts(kGreatestLabel + 1);
  std::size_t different = 0;
  const auto count_row = [&](std::span<const float> row) {
    for (const float value : row) {
      if (!(value >= 0 && value <= kGreatestLabel && value == std::floor(value))) return false;
      different += counts[static_cast<std::size_t>(value)]++ == 0 ? 1 : 0;
      if (different > LabelMap::kMaxLabels + 1) return false;
    }
    return true;
  };
  for (int k = 0; k < grid.geometry().dims[2]; ++k) {
    WorkProgress::done(0);
    for (int j = 0; j < grid.geometry().dims[1]; ++j) {
      if (!count_row(grid.row(j, k))) return {};
    }
  }
  if (different < 2 || counts[0] < *std::max_element(counts.begin(), counts.end())) return {};
  std::vector<int> ranks(counts.size());
  int rank = 0;
  for (std::size_t label = 0; label < counts.size(); ++label) ranks[label] = counts[label] > 0 ? rank++ : 0;
  return ranks;
}

}  // namespace

bool looks_like_labels(const DensityGrid& grid) {
  // Real label maps have at most 0.03 and at least 0.22; CTs of 3 to 16 levels have at least 0.29 for the
  // first or at most 0.014 for the second.
  constexpr double kOftenBetween = 0.2, kSeldomFar = 0.05;
  const std::vector<int> ranks = ranks_of(grid);
  if (ranks.empty()) return false;
  const auto& dims = grid.geometry().dims;
  const std::array<std::ptrdiff_t, 3> paces{1, grid.row_stride(), grid.slice_stride()};
  struct Count {
    std::size_t voxels = 0;
    std::size_t between = 0;
  };
  std::vector<Count> counts(static_cast<std::size_t>(*std::max_element(ranks.begin(), ranks.end())) + 1);
  std::size_t edges = 0, far = 0;
  const auto rank_at = [&](const float* at) { return ranks[static_cast<std::size_t>(*at)]; };
  for_each_with_progress(grid.geometry().all_voxels(), [&](const VoxelIndex& voxel) {
    const float* const here = grid.address_of(voxel);
    const int rank = rank_at(here);
    if (rank == 0) return;
    const std::array<int, 3> v{voxel.i, voxel.j, voxel.k};
    bool between = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int below = v[axis] > 0 ? rank_at(here - paces[axis]) : rank;
      const int above = v[axis] + 1 < dims[axis] ? rank_at(here + paces[axis]) : rank;
      between = between || (below < rank && rank < above) || (above < rank && rank < below);
      for (const int other : {below, above}) {
        edges += other != rank ? 1 : 0;
        far += std::abs(other - rank) > 1 ? 1 : 0;
      }
    }
    Count& count = counts[static_cast<std::size_t>(rank)];
    ++count.voxels;
    count.between += between ? 1 : 0;
  });
  const auto often = [](double share, std::size_t count, std::size_t of) {
    return static_cast<double>(count) >= share * static_cast<double>(of);
  };
  // With two values none can lie between others.
  return counts.size() == 2 || (often(kSeldomFar, far, edges) &&
                                std::none_of(std::next(counts.begin()), counts.end(), [&](const Count& of) {
                                  return often(kOftenBetween, of.between, of.voxels);
                                }));
}

double isovalue_of_labels(const DensityGrid& grid) {
  float lowest = std::numeric_limits<float>::max(), next = lowest;
  for_each_row(grid, [&](std::span<const float> row) {
    for (const float label : row) {
      if (label < lowest) next = std::exchange(lowest, label);
      if (label > lowest && label < next) next = label;
    }
  });
  return 0.5 * (static_cast<double>(lowest) +
                static_cast<double>(next < std::numeric_limits<float>::max() ? next : lowest));
}

DensityGrid bone_of_labels(const DensityGrid& labels, double isovalue) {
  std::vector<float> densities;
  densities.reserve(labels.geometry().voxel_count());
  const auto bone = static_cast<float>(isovalue + 0.5), other = static_cast<float>(isovalue - 0.5);
  for_each_row(labels, [&](std::span<const float> row) {
    for (const float label : row) densities.push_back(static_cast<double>(label) > isovalue ? bone : other);
  });
  return DensityGrid(labels.geometry(), std::move(densities));
}

}  // namespace osteomill
