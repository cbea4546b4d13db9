#include "slice_stack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "plausible_scan.h"

namespace osteomill {

namespace {

// Scanners round directions and positions to a few digits; these let that pass and no more.
constexpr double kDirectionTolerance = 1e-3;
constexpr double kSpacingTolerance = 1e-3;
constexpr double kSamePlace_mm = 1e-4;
// A distance may differ from the mean one by this share of it, and a slice be off its place in the grid by
// twice that, without being moved.
constexpr double kDistanceTolerance = 0.05;
// A gap wider than this share of those beside it lacks a slice.
constexpr double kMissing = 1.5;
// Largest distance between slices, mm, over which the bone may be interpolated.
constexpr double kMaxUnevenGap_mm = 10;
// An uneven stack becomes at most as many times as many slices.
constexpr double kMostSlices = 4;
// Sideways, in pixels: what cannot be seen after trilinear sampling.
constexpr double kSidewaysTolerance = 0.25;
// Gantries tilt by 30 degrees at most.
constexpr double kMaxTilt_deg = 45.0;

void check_plane(const std::string& subject, const SlicePlane& slice) {
  if (!(std::abs(slice.i_direction.norm() - 1) < 0.01 && std::abs(slice.j_direction.norm() - 1) < 0.01 &&
        std::abs(slice.i_direction.dot(slice.j_direction)) < kDirectionTolerance)) {
    throw InputError(subject,
                     slice.name + " has an orientation that is not two unit vectors at a right angle");
  }
}

void check_alike(const std::string& subject, const SlicePlane& first, const SlicePlane& other) {
  const auto refuse = [&](const std::string& reason) { throw InputError(subject, reason); };
  if (first.columns != other.columns || first.rows != other.rows) {
    refuse(fmt::format("slices differ in size: {} has {} x {} pixels, {} has {} x {}", first.name,
                       first.columns, first.rows, other.name, other.columns, other.rows));
  }
  const auto differ = [](double a, double b) { return std::abs(a - b) > kSpacingTolerance * a; };
  if (differ(first.column_distance_mm, other.column_distance_mm) ||
      differ(first.row_distance_mm, other.row_distance_mm)) {
    refuse(fmt::format("slices differ in pixel spacing: {} and {}", first.name, other.name));
  }
  if ((first.i_direction - other.i_direction).norm() > 2 * kDirectionTolerance ||
      (first.j_direction - other.j_direction).norm() > 2 * kDirectionTolerance) {
    refuse(fmt::format("slices differ in orientation: {} and {}", first.name, other.name));
  }
}

// Right-handed, with exact right angles; j is turned by what little it was off.
Mat3 axes_of(const SlicePlane& slice) {
  Mat3 axes;
  axes.col(0) = slice.i_direction.normalized();
  axes.col(2) = slice.i_direction.cross(slice.j_direction).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

void drop_copies(const std::string& subject, std::span<const SlicePlane> slices, const Vec3& normal,
                 SliceStack& stack) {
  std::vector<std::size_t> kept, copies;
  for (const std::size_t n : stack.order) {
    const bool first_here =
        kept.empty() ||
        !(normal.dot(slices[n].position_mm - slices[kept.back()].position_mm) < kSamePlace_mm);
    (first_here ? kept : copies).push_back(n);
    if (first_here) continue;
    const SlicePlane& below = slices[kept.back()];
    if (slices[n].instance.empty() || slices[n].instance != below.instance) {
      throw InputError(
          subject, fmt::format("{} and {} are different images at one position", below.name, slices[n].name));
    }
  }
  if (!copies.empty()) {
    stack.warnings.push_back(fmt::format("{} cop{} of other slices left out: {}", copies.size(),
                                         copies.size() == 1 ? "y" : "ies", slices[copies.front()].name));
  }
  stack.order = std::move(kept);
}

// How far each of the slices that were kept lies above the first.
std::vector<double> heights_of(std::span<const SlicePlane> slices, const Vec3& normal,
                               const SliceStack& stack) {
  const double lowest_mm = normal.dot(slices[stack.order.front()].position_mm);
  std::vector<double> heights_mm;
  for (const std::size_t n : stack.order) heights_mm.push_back(normal.dot(slices[n].position_mm) - lowest_mm);
  return heights_mm;
}

bool are_even(std::span<const double> heights_mm, std::span<const double> gaps_mm) {
  const double mean_mm = heights_mm.back() / static_cast<double>(gaps_mm.size());
  for (std::size_t k = 0; k < gaps_mm.size(); ++k) {
    // Small differences may add up.
    const double off_mm = heights_mm[k + 1] - mean_mm * static_cast<double>(k + 1);
    if (std::abs(gaps_mm[k] - mean_mm) > kDistanceTolerance * mean_mm ||
        std::abs(off_mm) > 2 * kDistanceTolerance * mean_mm)
      return false;
  }
  return true;
}

// If a table's feed was changed the distances that follow are alike; beside a lost slice they are not.
bool slice_is_missing(std::span<const double> gaps_mm, std::size_t k) {
  double beside_mm = 0;
  if (k > 0) beside_mm = gaps_mm[k - 1];
  if (k + 1 < gaps_mm.size()) beside_mm = std::max(beside_mm, gaps_mm[k + 1]);
  return gaps_mm.size() > 1 && gaps_mm[k] > kMissing * beside_mm;
}

// The grid's slices along the normal.
void place_slices(const std::string& subject, std::span<const SlicePlane> slices, const Vec3& normal,
                  SliceStack& stack) {
  std::vector<double> heights_mm = heights_of(slices, normal, stack);
  std::vector<double> gaps_mm;
  for (std::size_t k = 1; k < heights_mm.size(); ++k) gaps_mm.push_back(heights_mm[k] - heights_mm[k - 1]);
  const auto between = [&](std::size_t k) {
    return fmt::format("{:.6g} mm between {} and {}", gaps_mm[k], slices[stack.order[k]].name,
                       slices[stack.order[k + 1]].name);
  };
  std::vector<double> sorted_mm = gaps_mm;
  std::sort(sorted_mm.begin(), sorted_mm.end());
  const bool even = are_even(heights_mm, gaps_mm);
  for (std::size_t k = 0; k < gaps_mm.size() && !even; ++k) {
    if (slice_is_missing(gaps_mm, k)) {
      throw InputError(subject, fmt::format("a slice is missing: {}, {:.6g} mm usually", between(k),
                                            sorted_mm[(sorted_mm.size() - 1) / 2]));
    }
    if (gaps_mm[k] > kMaxUnevenGap_mm) {
      throw InputError(subject,
                       fmt::format("slices lie at uneven distances, too far to fill in: {}", between(k)));
    }
  }
  const double mean_mm = heights_mm.back() / static_cast<double>(gaps_mm.size());
  const double finest_mm = std::max(sorted_mm[sorted_mm.size() / 10], mean_mm / kMostSlices);
  const double steps = even ? static_cast<double>(gaps_mm.size()) : std::round(heights_mm.back() / finest_mm);
  stack.geometry.dims[2] = static_cast<int>(steps) + 1;
  stack.geometry.spacing_mm.z() = heights_mm.back() / steps;
  if (even) return;
  const auto widest = std::max_element(gaps_mm.begin(), gaps_mm.end());
  stack.warnings.push_back(
      fmt::format("slices lie at uneven distances, {:.6g} to {}: interpolated to {} slices {:.6g} mm apart",
                  sorted_mm.front(), between(static_cast<std::size_t>(widest - gaps_mm.begin())),
                  stack.geometry.dims[2], stack.geometry.spacing_mm.z()));
  stack.heights_mm = std::move(heights_mm);
}

void find_drift(const std::string& subject, std::span<const SlicePlane> slices, SliceStack& stack) {
  const Mat3& axes = stack.geometry.direction;
  const Vec3& spacing_mm = stack.geometry.spacing_mm;
  const auto offset_mm = [&](std::size_t n) -> Vec3 {
    return axes.transpose() * (slices[n].position_mm - slices[stack.order.front()].position_mm);
  };
  const Vec3 climb_mm = offset_mm(stack.order.back());
  for (const std::size_t n : stack.order) {
    const Vec3 here_mm = offset_mm(n);
    const Vec3 off_mm = here_mm - climb_mm * (here_mm.z() / climb_mm.z());
    if (std::abs(off_mm.x()) > kSidewaysTolerance * spacing_mm.x() ||
        std::abs(off_mm.y()) > kSidewaysTolerance * spacing_mm.y()) {
      throw InputError(subject, slices[n].name + " lies to the side of the other slices");
    }
  }
  if (std::abs(climb_mm.x()) > kSidewaysTolerance * spacing_mm.x() ||
      std::abs(climb_mm.y()) > kSidewaysTolerance * spacing_mm.y()) {
    stack.drift_i_mm = climb_mm.x() / (stack.geometry.dims[2] - 1);
    stack.drift_j_mm = climb_mm.y() / (stack.geometry.dims[2] - 1);
  }
}

// How far a slice is moved: in whole pixels, and the fraction by which it lies further.
struct Shift {
  int whole;
  double fraction;
};

Shift shift_of(double pixels) {
  const double whole = std::floor(pixels + 1e-9);
  return {static_cast<int>(whole), std::max(0.0, pixels - whole)};
}

}  // namespace

SliceStack stack_slices(const std::string& subject, std::span<const SlicePlane> slices) {
  if (slices.empty()) throw InputError(subject, "no slices");
  for (const SlicePlane& slice : slices) check_plane(subject, slice);
  for (const SlicePlane& slice : slices) check_alike(subject, slices.front(), slice);

  SliceStack stack;
  stack.geometry.direction = axes_of(slices.front());
  const Vec3 normal = stack.geometry.direction.col(2);
  stack.order.resize(slices.size());
  std::iota(stack.order.begin(), stack.order.end(), std::size_t{0});
  std::stable_sort(stack.order.begin(), stack.order.end(), [&](std::size_t a, std::size_t b) {
    return normal.dot(slices[a].position_mm) < normal.dot(slices[b].position_mm);
  });
  drop_copies(subject, slices, normal, stack);
  if (stack.order.size() < 2) {
    throw InputError(subject,
                     "only one slice: its thickness cannot be known, and a volume needs at least two");
  }
  const SlicePlane& lowest = slices[stack.order.front()];
  stack.geometry.dims = {lowest.columns, lowest.rows, 0};
  stack.geometry.spacing_mm = {lowest.column_distance_mm, lowest.row_distance_mm, 0};
  stack.geometry.origin_mm = lowest.position_mm;
  place_slices(subject, slices, normal, stack);
  check_plausible(subject, stack.geometry);
  find_drift(subject, slices, stack);
  return stack;
}

void even_out_slices(SliceStack& stack, std::vector<float>& densities) {
  if (stack.heights_mm.empty()) return;
  const std::vector<double> heights_mm = std::exchange(stack.heights_mm, {});
  const std::size_t slice_size = densities.size() / heights_mm.size();
  std::vector<float> even;
  even.reserve(stack.geometry.voxel_count());
  for (int k = 0; k < stack.geometry.dims[2]; ++k) {
    const double height_mm = stack.geometry.spacing_mm.z() * k;
    const auto above = std::clamp(std::upper_bound(heights_mm.begin(), heights_mm.end(), height_mm),
                                  heights_mm.begin() + 1, heights_mm.end() - 1);
    const double share = std::clamp((height_mm - above[-1]) / (above[0] - above[-1]), 0.0, 1.0);
    const float* const lower =
        densities.data() + static_cast<std::size_t>(above - heights_mm.begin() - 1) * slice_size;
    const float* const upper = lower + slice_size;
    for (std::size_t n = 0; n < slice_size; ++n) {
      even.push_back(static_cast<float>((1 - share) * static_cast<double>(lower[n]) +
                                        share * static_cast<double>(upper[n])));
    }
  }
  densities = std::move(even);
}

void correct_gantry_tilt(const std::string& subject, SliceStack& stack, std::vector<float>& densities) {
  if (stack.drift_i_mm == 0 && stack.drift_j_mm == 0) return;
  GridGeometry& geometry = stack.geometry;
  const double tilt_deg =
      std::atan2(std::hypot(stack.drift_i_mm, stack.drift_j_mm), geometry.spacing_mm.z()) * 180 /
      std::numbers::pi;
  if (tilt_deg > kMaxTilt_deg) {
    throw InputError(subject,
                     fmt::format("slices lean by {:.1f} degrees, which is no gantry tilt", tilt_deg));
  }
  const auto [columns, rows, count] = geometry.dims;
  const std::array<double, 2> step{stack.drift_i_mm / geometry.spacing_mm.x(),
                                   stack.drift_j_mm / geometry.spacing_mm.y()};
  std::array<int, 2> first{};
  std::array<int, 3> dims = geometry.dims;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double drift = step[axis] * (count - 1);
    first[axis] = static_cast<int>(std::floor(std::min(0.0, drift)));
    dims[axis] += static_cast<int>(std::ceil(std::abs(drift)));
  }
  if (cell_count(dims) > 4 * densities.size()) {
    throw InputError(subject,
                     fmt::format("slices lean by {:.1f} degrees, too far to put them straight", tilt_deg));
  }
  const float outside = *std::min_element(densities.begin(), densities.end());
  std::vector<float> moved;
  moved.reserve(cell_count(dims));
  for_each({{0, 0, 0}, {dims[0] - 1, dims[1] - 1, count - 1}},
           [&, columns = columns, rows = rows](const VoxelIndex& v) {
             const auto at = [&](int i, int j) {
               const bool inside = i >= 0 && j >= 0 && i < columns && j < rows;
               return static_cast<double>(inside ? densities[row_major(geometry.dims, i, j, v.k)] : outside);
             };
             const Shift shift_i = shift_of(step[0] * v.k), shift_j = shift_of(step[1] * v.k);
             const double a = shift_i.fraction, b = shift_j.fraction;
             const int i = v.i + first[0] - shift_i.whole, j = v.j + first[1] - shift_j.whole;
             const double here = (1 - a) * at(i, j) + a * at(i - 1, j);
             const double above = (1 - a) * at(i, j - 1) + a * at(i - 1, j - 1);
             moved.push_back(static_cast<float>((1 - b) * here + b * above));
           });
  geometry.origin_mm = geometry.world_from_voxel(Vec3(first[0], first[1], 0));
  geometry.dims = dims;
  stack.drift_i_mm = stack.drift_j_mm = 0;
  stack.warnings.push_back(fmt::format(
      "the gantry was tilted by {:.1f} degrees: slices were shifted into a straight grid of {} x {} x {}",
      tilt_deg, dims[0], dims[1], dims[2]));
  densities = std::move(moved);
}

}  // namespace osteomill
