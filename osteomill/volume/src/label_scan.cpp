#include "osteomill/volume/label_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "osteomill/base/work_progress.h"
#include "osteomill/volume/label_map.h"

namespace osteomill {

namespace {

constexpr int kMaxLabel = std::numeric_limits<std::int16_t>::max();

// Distinct values of a grid, if they are few whole numbers from 0 up.
struct Values {
  // Voxel count by value; empty if the grid has other values.
  std::vector<std::size_t> counts;
  std::size_t different = 0;
};

Values values_of(const DensityGrid& grid) {
  Values values{std::vector<std::size_t>(kMaxLabel + 1)};
  const auto count_row = [&](std::span<const float> row) {
    for (const float value : row) {
      if (!(value >= 0 && value <= kMaxLabel && value == std::floor(value))) return false;
      values.different += values.counts[static_cast<std::size_t>(value)]++ == 0 ? 1 : 0;
      if (values.different > LabelMap::kMaxLabels + 1) return false;
    }
    return true;
  };
  for (int k = 0; k < grid.geometry().dims[2]; ++k) {
    WorkProgress::done(0);
    for (int j = 0; j < grid.geometry().dims[1]; ++j) {
      if (!count_row(grid.row(j, k))) return {};
    }
  }
  return values;
}

// No rank: the value has too few voxels to count.
constexpr int kRare = -1;

// Rank by value among the values that occur. The rarest values, together at most 0.5 % of the voxels that are
// not 0, get kRare.
std::vector<int> ranks_of(const Values& values) {
  constexpr double kRareShare = 0.005;
  const std::size_t labelled =
      std::accumulate(std::next(values.counts.begin()), values.counts.end(), std::size_t{0});
  std::vector<std::size_t> found;
  for (std::size_t value = 1; value < values.counts.size(); ++value)
    if (values.counts[value] > 0) found.push_back(value);
  std::vector<std::size_t> rarest_first = found;
  std::stable_sort(rarest_first.begin(), rarest_first.end(),
                   [&](std::size_t a, std::size_t b) { return values.counts[a] < values.counts[b]; });
  std::vector<int> ranks(values.counts.size());
  std::size_t sum = 0;
  for (const std::size_t value : rarest_first) {
    sum += values.counts[value];
    if (static_cast<double>(sum) > kRareShare * static_cast<double>(labelled)) break;
    ranks[value] = kRare;
  }
  int rank = 0;
  for (const std::size_t value : found)
    if (ranks[value] != kRare) ranks[value] = ++rank;
  return ranks;
}

// Statistics of the differences between neighbouring values.
struct Edges {
  // Share of edges that skip at least one rank.
  double far = 0;
  // Share of the voxels, except those of value 0, whose value often lies between a lower and a higher
  // neighbour.
  double between = 0;
};

Edges edges_of(const DensityGrid& grid, const std::vector<int>& ranks) {
  // Minimum share of a value's voxels to count as often.
  constexpr double kOften = 0.2;
  struct Count {
    std::size_t voxels = 0;
    std::size_t between = 0;
  };
  const auto& dims = grid.geometry().dims;
  const std::array<std::ptrdiff_t, 3> paces{1, grid.row_stride(), grid.slice_stride()};
  std::vector<Count> counts(static_cast<std::size_t>(*std::max_element(ranks.begin(), ranks.end())) + 1);
  std::size_t edges = 0, far = 0;
  for_each_with_progress(grid.geometry().all_voxels(), [&](const VoxelIndex& voxel) {
    const float* const here = grid.address_of(voxel);
    const int rank = ranks[static_cast<std::size_t>(*here)];
    if (rank <= 0) return;
    const auto rank_at = [&](std::ptrdiff_t pace) {
      const int other = ranks[static_cast<std::size_t>(here[pace])];
      return other == kRare ? rank : other;
    };
    const std::array<int, 3> v{voxel.i, voxel.j, voxel.k};
    bool between = false;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int below = v[axis] > 0 ? rank_at(-paces[axis]) : rank;
      const int above = v[axis] + 1 < dims[axis] ? rank_at(paces[axis]) : rank;
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
  std::size_t all = 0, often_between = 0;
  for (const Count& count : counts) {
    all += count.voxels;
    if (static_cast<double>(count.between) >= kOften * static_cast<double>(count.voxels))
      often_between += count.voxels;
  }
  const auto share = [](std::size_t count, std::size_t of) {
    return of == 0 ? 0 : static_cast<double>(count) / static_cast<double>(of);
  };
  return {share(far, edges), share(often_between, all)};
}

}  // namespace

LabelGuess guess_labels(const DensityGrid& grid) {
  // Measured: real label maps have `far` >= 0.23 and `between` = 0; CTs and phantoms quantised to 3 to 256
  // levels have `far` <= 0.05 or `between` >= 0.018.
  constexpr double kMinNonadjacentShare = 0.05, kMaxBetweenShareOfLabels = 0.01,
                   kMinBetweenShareOfDensities = 0.05;
  constexpr std::size_t kFewLevels = 32;
  const Values values = values_of(grid);
  if (values.different < 2) return LabelGuess::densities;
  const bool mostly_0 = values.counts[0] == *std::max_element(values.counts.begin(), values.counts.end());
  // With two values, neither can lie between others, and a mask gives the same bone as labels or as a scan.
  if (values.different == 2) return mostly_0 ? LabelGuess::labels : LabelGuess::densities;
  const Edges edges = edges_of(grid, ranks_of(values));
  const bool has_nonadjacent_edges = edges.far >= kMinNonadjacentShare;
  if (mostly_0 && has_nonadjacent_edges && edges.between <= kMaxBetweenShareOfLabels)
    return LabelGuess::labels;
  if ((mostly_0 && values.different <= kFewLevels) ||
      (values.counts[0] > 0 && has_nonadjacent_edges && edges.between < kMinBetweenShareOfDensities))
    return LabelGuess::unclear;
  return LabelGuess::densities;
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
