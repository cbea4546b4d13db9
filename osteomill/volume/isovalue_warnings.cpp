#include "osteomill/volume/isovalue_warnings.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "osteomill/numbers/work_progress.h"

namespace osteomill {

namespace {

// Single voxels of noise are no bone.
constexpr double kTouchingShare = 1e-3;

struct Range {
  double min;
  double max;
  bool holds(double isovalue) const { return isovalue < max && isovalue >= min; }
};

Range range_of(const CopyOnWriteFloats& densities) {
  constexpr std::size_t kAtOnce = 1 << 22;
  float min = densities.front(), max = min;
  for (std::size_t first = 0; first < densities.size(); first += kAtOnce) {
    const std::size_t last = std::min(first + kAtOnce, densities.size());
    const auto [low, high] = std::minmax_element(densities.begin() + first, densities.begin() + last);
    min = std::min(min, *low);
    max = std::max(max, *high);
    WorkProgress::done(first, 2 * densities.size());
  }
  return {static_cast<double>(min), static_cast<double>(max)};
}

bool touches(const DensityGrid& grid, double isovalue, std::size_t axis, int place) {
  const auto& dims = grid.geometry().dims;
  const std::size_t across = (axis + 1) % 3, up = (axis + 2) % 3;
  long bone = 0;
  std::array<int, 3> v{};
  v[axis] = place;
  for (v[across] = 0; v[across] < dims[across]; ++v[across])
    for (v[up] = 0; v[up] < dims[up]; ++v[up])
      bone += static_cast<double>(grid[{v[0], v[1], v[2]}]) > isovalue;
  return static_cast<double>(bone) > kTouchingShare * dims[across] * dims[up];
}

}  // namespace

bool is_within(const DensityGrid& grid, double isovalue) {
  return range_of(grid.densities()).holds(isovalue);
}

std::vector<std::string> isovalue_warnings(const DensityGrid& grid, double isovalue) {
  if (const Range range = range_of(grid.densities()); !range.holds(isovalue)) {
    return {fmt::format("the isovalue {:g} lies outside its values, {:g} to {:g}: {}", isovalue, range.min,
                        range.max, isovalue < range.min ? "all of it is bone" : "there is no bone")};
  }
  std::string faces;
  int count = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const int place : {0, grid.geometry().dims[axis] - 1}) {
      if (!touches(grid, isovalue, axis, place)) continue;
      faces += fmt::format("{}{} {}", count++ == 0 ? "" : ", ", place == 0 ? "first" : "last", "ijk"[axis]);
    }
  }
  if (count == 0) return {};
  return {fmt::format("bone touches the border of the volume ({}) and is cut off there", faces)};
}

}  // namespace osteomill
