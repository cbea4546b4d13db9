#include "osteomill/ct/slice_stack.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "osteomill/ct/plausible_scan.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

// Scanners round directions and positions to a few digits; these let that pass and no more.
constexpr double kDirectionTolerance = 1e-3;
constexpr double kSpacingTolerance = 1e-3;
constexpr double kSamePlace_mm = 1e-4;
// A distance may differ from the usual one by this share of it, and a slice be off its place in the grid by
// twice that.
constexpr double kDistanceTolerance = 0.05;
// Sideways, in pixels: what cannot be seen after trilinear sampling.
constexpr double kSidewaysTolerance = 0.25;

void check_plane(const std::string& subject, const SlicePlane& slice) {
  const auto refuse = [&](const std::string& reason) {
    throw InputError(subject, slice.name + " " + reason);
  };
  if (slice.columns < 1 || slice.rows < 1) {
    refuse(fmt::format("has no pixels ({} columns x {} rows)", slice.columns, slice.rows));
  }
  for (const double distance : {slice.column_distance_mm, slice.row_distance_mm}) {
    if (!std::isfinite(distance) || distance <= 0) {
      refuse(fmt::format("has a pixel spacing of {} mm, which is no distance", distance));
    }
  }
  if (!slice.position_mm.allFinite()) refuse("has a position that is not a number");
  const double i_length = slice.i_direction.norm();
  const double j_length = slice.j_direction.norm();
  if (!(std::abs(i_length - 1) < 0.01 && std::abs(j_length - 1) < 0.01 &&
        std::abs(slice.i_direction.dot(slice.j_direction)) < kDirectionTolerance)) {
    refuse("has an orientation that is not two unit vectors at a right angle");
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
  std::vector<std::size_t> kept;
  for (const std::size_t n : stack.order) {
    if (!kept.empty()) {
      const SlicePlane& below = slices[kept.back()];
      const SlicePlane& slice = slices[n];
      if (normal.dot(slice.position_mm - below.position_mm) < kSamePlace_mm) {
        if (slice.instance.empty() || slice.instance != below.instance) {
          throw InputError(
              subject, fmt::format("{} and {} are different images at one position", below.name, slice.name));
        }
        stack.warnings.push_back(fmt::format("{} is a copy of {} and was left out", slice.name, below.name));
        continue;
      }
    }
    kept.push_back(n);
  }
  stack.order = std::move(kept);
}

// The lower of the two in the middle: a hole is wider than what is usual.
double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void check_distances(const std::string& subject, std::span<const SlicePlane> slices, const Vec3& normal,
                     SliceStack& stack) {
  const std::size_t count = stack.order.size();
  std::vector<double> heights_mm;
  for (const std::size_t n : stack.order) heights_mm.push_back(normal.dot(slices[n].position_mm));
  std::vector<double> gaps_mm;
  for (std::size_t k = 1; k < count; ++k) gaps_mm.push_back(heights_mm[k] - heights_mm[k - 1]);
  const double usual_mm = median_of(gaps_mm);
  const double mean_mm = (heights_mm.back() - heights_mm.front()) / static_cast<double>(count - 1);

  const auto complain = [&](const char* what, std::size_t k) {
    throw InputError(subject,
                     fmt::format("{}: {:.6g} mm between {} and {}, {:.6g} mm usually", what, gaps_mm[k - 1],
                                 slices[stack.order[k - 1]].name, slices[stack.order[k]].name, usual_mm));
  };
  for (std::size_t k = 1; k < count; ++k) {
    if (gaps_mm[k - 1] > 1.5 * usual_mm) complain("a slice is missing", k);
    if (std::abs(gaps_mm[k - 1] - usual_mm) > kDistanceTolerance * usual_mm) {
      complain("slices lie at uneven distances", k);
    }
  }
  // Small differences may add up.
  for (std::size_t k = 1; k < count; ++k) {
    const double off_mm = heights_mm[k] - heights_mm[0] - mean_mm * static_cast<double>(k);
    if (std::abs(off_mm) > 2 * kDistanceTolerance * usual_mm) complain("slices lie at uneven distances", k);
  }
  stack.geometry.spacing_mm.z() = mean_mm;
}

void find_drift(const std::string& subject, std::span<const SlicePlane> slices, SliceStack& stack) {
  const Mat3& axes = stack.geometry.direction;
  const Vec3& first_mm = slices[stack.order.front()].position_mm;
  const double steps = static_cast<double>(stack.order.size() - 1);
  const Vec3 climb_mm = axes.transpose() * (slices[stack.order.back()].position_mm - first_mm);
  const double drift_i_mm = climb_mm.x() / steps;
  const double drift_j_mm = climb_mm.y() / steps;
  const Vec3& spacing_mm = stack.geometry.spacing_mm;
  for (std::size_t k = 0; k < stack.order.size(); ++k) {
    const SlicePlane& slice = slices[stack.order[k]];
    const Vec3 offset_mm = axes.transpose() * (slice.position_mm - first_mm);
    const double off_i = (offset_mm.x() - drift_i_mm * static_cast<double>(k)) / spacing_mm.x();
    const double off_j = (offset_mm.y() - drift_j_mm * static_cast<double>(k)) / spacing_mm.y();
    if (std::abs(off_i) > kSidewaysTolerance || std::abs(off_j) > kSidewaysTolerance) {
      throw InputError(subject, slice.name + " lies to the side of the other slices");
    }
  }
  if (std::abs(climb_mm.x()) > kSidewaysTolerance * spacing_mm.x() ||
      std::abs(climb_mm.y()) > kSidewaysTolerance * spacing_mm.y()) {
    stack.drift_i_mm = drift_i_mm;
    stack.drift_j_mm = drift_j_mm;
  }
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
  stack.geometry.dims = {lowest.columns, lowest.rows, static_cast<int>(stack.order.size())};
  stack.geometry.spacing_mm = {lowest.column_distance_mm, lowest.row_distance_mm, 0};
  stack.geometry.origin_mm = lowest.position_mm;
  check_distances(subject, slices, normal, stack);
  check_plausible(subject, stack.geometry);
  find_drift(subject, slices, stack);
  return stack;
}

}  // namespace osteomill
