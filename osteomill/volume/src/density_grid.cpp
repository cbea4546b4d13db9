#include "osteomill/volume/density_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <utility>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

// A burr at 20 mm/s covers this distance in 25 ms.
constexpr double kAhead_mm = 0.5;

RowLayout layout_of(const GridGeometry& geometry) {
  const auto& [i, j, k] = geometry.dims;
  return RowLayout::with_padding(static_cast<std::size_t>(i), static_cast<std::size_t>(j),
                                 static_cast<std::size_t>(k));
}

// Marks voxels without density; null if all have one.
std::shared_ptr<const std::vector<bool>> without_density(const std::vector<float>& densities) {
  const auto has_none = [](float density) { return std::isnan(density); };
  if (std::none_of(densities.begin(), densities.end(), has_none)) return nullptr;
  auto without = std::make_shared<std::vector<bool>>(densities.size());
  std::transform(densities.begin(), densities.end(), without->begin(), has_none);
  return without;
}

// Replaces NaN by the lowest density. Throws if no voxel has a density.
std::vector<float> filled(const GridGeometry& geometry, std::vector<float> densities) {
  const auto is_less = [](float a, float b) { return a < b || (std::isnan(b) && !std::isnan(a)); };
  const auto least = std::min_element(densities.begin(), densities.end(), is_less);
  if (densities.size() != geometry.voxel_count() || least == densities.end() || std::isnan(*least)) {
    throw std::invalid_argument("DensityGrid: needs one density per voxel, at least one of them not NaN");
  }
  const float lowest = *least;
  std::replace_if(
      densities.begin(), densities.end(), [](float density) { return std::isnan(density); }, lowest);
  return densities;
}

}  // namespace

DensityGrid::DensityGrid(const GridGeometry& geometry, std::vector<float> densities)
    : geometry_(geometry),
      layout_(layout_of(geometry)),
      without_density_(without_density(densities)),
      densities_(filled(geometry, std::move(densities)), layout_),
      outside_density_(*densities_.data()) {
  for_each_row(*this, [this](std::span<const float> row) {
    outside_density_ = std::min(outside_density_, *std::min_element(row.begin(), row.end()));
  });
  if (without_density_) {
    voxels_without_density_ =
        static_cast<std::size_t>(std::count(without_density_->begin(), without_density_->end(), true));
  }
}

void DensityGrid::prefault_around(const VoxelBox& changed) {
  if (changed.empty()) return;
  const auto grown = [&](double by_mm) {
    std::array<int, 3> by;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      by[axis] = static_cast<int>(by_mm / geometry_.spacing_mm[static_cast<Eigen::Index>(axis)]) + 1;
    }
    const auto& [first, last] = changed;
    return VoxelBox{{first.i - by[0], first.j - by[1], first.k - by[2]},
                    {last.i + by[0], last.j + by[1], last.k + by[2]}}
        .intersected(geometry_.all_voxels());
  };
  const VoxelBox near = grown(kAhead_mm);
  if (near.intersected(prefaulted_) == near) return;
  // Twice as far, so that it need not be repeated for every voxel the burr advances.
  prefaulted_ = grown(2 * kAhead_mm);
  const auto& [first, last] = prefaulted_;
  for (int k = first.k; k <= last.k; ++k) {
    densities_.prefault(offset_of(first.i, first.j, k), offset_of(last.i, last.j, k));
  }
}

std::vector<float> every_nth_density(const DensityGrid& grid, std::size_t every) {
  const auto& dims = grid.geometry().dims;
  std::vector<float> densities;
  densities.reserve(cell_count(dims) / every + 1);
  for (std::size_t n = 0; n < cell_count(dims); n += every) {
    const auto& [i, j, k] = cell_at(dims, n);
    if (grid.has_density(n)) densities.push_back(grid[{i, j, k}]);
  }
  // Falls back to all voxels: few have a density, and none of these.
  if (densities.empty() && every > 1) return every_nth_density(grid, 1);
  return densities;
}

std::uint64_t fingerprint_of(const DensityGrid& grid) {
  WordHash hash;
  for_each_row(grid, [&](std::span<const float> row) {
    for (const float density : row) hash.add(std::bit_cast<std::uint32_t>(density));
  });
  return hash.value();
}

}  // namespace osteomill
