#include "osteomill/volume/label_scan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

// Calls `use` with every density in turn, along i fastest; it returns whether to go on.
template <typename Use>
void for_each_density(const DensityGrid& grid, const Use& use) {
  const auto& dims = grid.geometry().dims;
  for (int k = 0; k < dims[2]; ++k) {
    WorkProgress::done(0);
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) {
        if (!use(grid[{i, j, k}])) return;
      }
    }
  }
}

}  // namespace

std::optional<double> isovalue_of_labels(const DensityGrid& grid) {
  constexpr std::size_t kMaxLabels = 256;
  struct Count {
    std::size_t voxels = 0;
    std::size_t like_the_one_before = 0;
  };
  std::map<float, Count> counts;
  Count* count = nullptr;
  float last = 0;
  bool labels = true;
  for_each_density(grid, [&](float density) {
    const bool alike = count != nullptr && density == last;
    if (!alike) {
      labels = density == std::floor(density);
      count = &counts[density];
      labels = labels && counts.size() <= kMaxLabels;
    }
    last = density;
    ++count->voxels;
    count->like_the_one_before += alike ? 1 : 0;
    return labels;
  });
  if (!labels || counts.size() < 2) return std::nullopt;
  // Structures are pieces, unlike the shades of a soft edge or noise.
  const auto pieces = std::count_if(std::next(counts.begin()), counts.end(), [](const auto& entry) {
    return 2 * entry.second.like_the_one_before >= entry.second.voxels;
  });
  if (2 * static_cast<std::size_t>(pieces) < counts.size() - 1) return std::nullopt;
  return 0.5 *
         (static_cast<double>(counts.begin()->first) + static_cast<double>(std::next(counts.begin())->first));
}

DensityGrid bone_of_labels(const DensityGrid& labels, double isovalue) {
  std::vector<float> densities;
  densities.reserve(labels.geometry().voxel_count());
  const auto bone = static_cast<float>(isovalue + 0.5), other = static_cast<float>(isovalue - 0.5);
  for_each_density(labels, [&](float label) {
    densities.push_back(static_cast<double>(label) > isovalue ? bone : other);
    return true;
  });
  return DensityGrid(labels.geometry(), std::move(densities));
}

}  // namespace osteomill
