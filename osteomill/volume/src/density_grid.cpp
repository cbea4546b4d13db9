#include "osteomill/volume/density_grid.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <utility>

#include "osteomill/base/work_progress.h"

namespace osteomill {

namespace {

// Distance that a burr at 20 mm/s covers in 25 ms.
constexpr double kAhead_mm = 0.5;

RowLayout layout_of(const GridGeometry& geometry) {
  const auto& [i, j, k] = geometry.dims;
  return RowLayout::apart(static_cast<std::size_t>(i), static_cast<std::size_t>(j),
                          static_cast<std::size_t>(k));
}

// Returns the densities. Throws if their number is not that of the voxels, or zero.
std::vector<float> checked(const GridGeometry& geometry, std::vector<float> densities) {
  if (densities.empty() || densities.size() != geometry.voxel_count()) {
    throw std::invalid_argument("DensityGrid: as many densities as voxels, and at least one");
  }
  return densities;
}

}  // namespace

DensityGrid::DensityGrid(const GridGeometry& geometry, std::vector<float> densities)
    : geometry_(geometry),
      layout_(layout_of(geometry)),
      densities_(checked(geometry, std::move(densities)), layout_),
      outside_density_(*densities_.data()) {
  for_each_row(*this, [this](std::span<const float> row) {
    outside_density_ = std::min(outside_density_, *std::min_element(row.begin(), row.end()));
  });
}

void DensityGrid::prepare_about(const VoxelBox& changed) {
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
  if (near.intersected(prepared_) == near) return;
  // Twice as far, so that it is not due again with every voxel that the burr goes on.
  prepared_ = grown(2 * kAhead_mm);
  const auto& [first, last] = prepared_;
  for (int k = first.k; k <= last.k; ++k) {
    densities_.prepare(place(first.i, first.j, k), place(last.i, last.j, k));
  }
}

std::vector<float> every_nth_density(const DensityGrid& grid, std::size_t every) {
  const auto& dims = grid.geometry().dims;
  std::vector<float> densities;
  densities.reserve(cell_count(dims) / every + 1);
  for (std::size_t n = 0; n < cell_count(dims); n += every) {
    const auto& [i, j, k] = cell_at(dims, n);
    densities.push_back(grid[{i, j, k}]);
  }
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
