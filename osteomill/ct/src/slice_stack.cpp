#include "slice_stack.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "plausible_scan.h"

namespace osteomill {

namespace {

// Tolerances for the rounding of directions and spacings by scanners.
constexpr double kDirectionTolerance = 1e-3;
constexpr double kSpacingTolerance = 1e-3;
// Even slices: distances may differ from the mean by this fraction of it, and positions from the grid by
// twice that.
constexpr double kDistanceTolerance = 0.05;
// If a gap is wider than this multiple of its neighbours, a slice is missing.
constexpr double kMissing = 1.5;
// Largest gap, mm, over which bone may be interpolated.
constexpr double kMaxUnevenGap_mm = 10;
// Resampling an uneven stack multiplies the number of slices by at most this.
constexpr double kMostSlices = 4;
// Sideways offset, pixels, that is invisible after trilinear sampling.
constexpr double kSidewaysTolerance = 0.25;
// Gantries tilt by 30 degrees at most.
constexpr double kMaxTilt_deg = 45.0;

void check_plane(const std::string& subject, const SlicePlane& slice) {
  if (!(std::abs(slice.i_direction.norm() - 1) < 0.01 && std::abs(slice.j_direction.norm() - 1) < 0.01 &&
        std::abs(slice.i_direction.dot(slice.j_direction)) < kDirectionTolerance)) {
    throw InputError(subject, slice.name + " has an orientation that is not two orthogonal unit vectors");
  }
}

void check_alike(const std::string& subject, const SlicePlane& first, const SlicePlane& other) {
  const char* const difference = difference_of(first, other);
  if (difference == nullptr) return;
  if (first.columns != other.columns || first.rows != other.rows) {
    throw InputError(subject,
                     fmt::format("slices differ in size: {} has {} x {} pixels, {} has {} x {}", first.name,
                                 first.columns, first.rows, other.name, other.columns, other.rows));
  }
  throw InputError(subject,
                   fmt::format("slices differ in {}: {} and {}", difference, first.name, other.name));
}

// Returns exactly orthogonal, right-handed axes; adjusts j.
Mat3 axes_of(const SlicePlane& slice) {
  Mat3 axes;
  axes.col(0) = slice.i_direction.normalized();
  axes.col(2) = slice.i_direction.cross(slice.j_direction).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

// Drops coincident copies of slices. Returns the first two coincident slices that are not copies, if any.
std::optional<std::pair<std::size_t, std::size_t>> drop_copies(std::span<const SlicePlane> slices,
                                                               const Vec3& normal, const SamePixels& is_copy,
                                                               SliceStack& stack) {
  std::vector<std::size_t> kept, copies;
  std::optional<std::pair<std::size_t, std::size_t>> others;
  for (const std::size_t n : stack.order) {
    const auto is_elsewhere = [&](std::size_t other) {
      return !(normal.dot(slices[n].position_mm - slices[other].position_mm) < kSamePlace_mm);
    };
    const auto last_below = std::find_if(kept.rbegin(), kept.rend(), is_elsewhere);
    const bool copied =
        std::any_of(kept.rbegin(), last_below, [&](std::size_t other) { return is_copy(other, n); });
    if (!copied && last_below != kept.rbegin() && !others) others = {kept.back(), n};
    (copied ? copies : kept).push_back(n);
  }
  if (!copies.empty()) {
    stack.warnings.push_back(fmt::format("{} cop{} of other slices left out: {}", copies.size(),
                                         copies.size() == 1 ? "y" : "ies", slices[copies.front()].name));
  }
  stack.order = std::move(kept);
  return others;
}

// Returns the heights of the stack's slices above the first.
std::vector<double> heights_of(std::span<const SlicePlane> slices, const Vec3& normal,
                               const SliceStack& stack) {
  const double lowest_mm = normal.dot(slices[stack.order.front()].position_mm);
  std::vector<double> heights_mm;
  for (const std::size_t n : stack.order) heights_mm.push_back(normal.dot(slices[n].position_mm) - lowest_mm);
  return heights_mm;
}

std::vector<double> gaps_between(std::span<const double> heights_mm) {
  std::vector<double> gaps_mm;
  for (std::size_t k = 1; k < heights_mm.size(); ++k) gaps_mm.push_back(heights_mm[k] - heights_mm[k - 1]);
  return gaps_mm;
}

bool are_even(std::span<const double> heights_mm, std::span<const double> gaps_mm) {
  const double mean_mm = heights_mm.back() / static_cast<double>(gaps_mm.size());
  for (std::size_t k = 0; k < gaps_mm.size(); ++k) {
    // Small differences may accumulate.
    const double off_mm = heights_mm[k + 1] - mean_mm * static_cast<double>(k + 1);
    if (std::abs(gaps_mm[k] - mean_mm) > kDistanceTolerance * mean_mm ||
        std::abs(off_mm) > 2 * kDistanceTolerance * mean_mm)
      return false;
  }
  return true;
}

// Returns the slices in order of their numbers, lowest position first; empty if the numbers are not
// consecutive.
std::vector<std::size_t> order_by_number(std::span<const SlicePlane> slices, const Vec3& normal,
                                         std::vector<std::size_t> order) {
  for (const std::size_t n : order) {
    if (!slices[n].number) return {};
  }
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return *slices[a].number < *slices[b].number; });
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (static_cast<long>(*slices[order[k]].number) - *slices[order[k - 1]].number != 1) return {};
  }
  if (normal.dot(slices[order.back()].position_mm - slices[order.front()].position_mm) < 0)
    std::reverse(order.begin(), order.end());
  return order;
}

// Returns whether some straight line over k is within `within` of all values.
bool fit_on_a_line(std::span<const double> values, double within) {
  const auto spread = [&](double slope) {
    double least = values.front(), most = least;
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double off = values[k] - slope * static_cast<double>(k);
      least = std::min(least, off);
      most = std::max(most, off);
    }
    return most - least;
  };
  // The spread is a convex function of the slope.
  const auto steps = static_cast<double>(values.size() - 1);
  const double mean = (values.back() - values.front()) / steps;
  double low = mean - 2 * within / steps, high = mean + 2 * within / steps;
  for (int n = 0; n < 60; ++n) {
    const double a = low + (high - low) / 3, b = high - (high - low) / 3;
    (spread(a) < spread(b) ? high : low) = spread(a) < spread(b) ? b : a;
  }
  constexpr double kTie = 1 + 1e-6;
  return spread(0.5 * (low + high)) <= 2 * within * kTie;
}

// Returns the last decimal of positions, projected onto the normal, mm. Common trailing zeros count as
// decimals unless slices coincide, which proves that they are not significant.
double last_decimal_mm(std::span<const SlicePlane> slices, const SliceStack& stack, const Vec3& normal,
                       bool at_one_place) {
  double step_mm = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    int decimals = 0;
    for (const std::size_t n : stack.order)
      decimals = std::max(decimals, slices[n].decimals[static_cast<std::size_t>(axis)]);
    const auto ends_in_zero = [&](std::size_t n) {
      const double tens = slices[n].position_mm[axis] * std::pow(10.0, decimals - 1);
      return std::abs(tens - std::round(tens)) < 1e-3;
    };
    while (at_one_place && decimals > 0 && std::all_of(stack.order.begin(), stack.order.end(), ends_in_zero))
      --decimals;
    step_mm += std::abs(normal[axis]) * std::pow(10.0, -decimals);
  }
  return step_mm;
}

// Returns whether every height has the same number of slices, as with several time points.
bool have_equal_counts(const std::vector<double>& heights_mm) {
  std::vector<std::size_t> counts;
  for (std::size_t k = 0; k < heights_mm.size(); ++k) {
    if (k == 0 || heights_mm[k] - heights_mm[k - 1] > kSamePlace_mm) counts.push_back(0);
    ++counts.back();
  }
  return std::all_of(counts.begin(), counts.end(),
                     [&](std::size_t count) { return count == counts.front(); });
}

// Sorts slices by number if rounded positions explain why they are uneven. Returns whether it did.
bool are_rounded(const std::string& subject, std::span<const SlicePlane> slices, const Vec3& normal,
                 bool at_one_place, SliceStack& stack) {
  // Minimum height in rounding steps; below it, the slice distance is undetermined.
  constexpr double kLeastHeight = 8;
  const double step_mm = last_decimal_mm(slices, stack, normal, at_one_place);
  SliceStack numbered = stack;
  numbered.order = order_by_number(slices, normal, stack.order);
  if (numbered.order.size() < 3) return false;
  const std::vector<double> heights_mm = heights_of(slices, normal, numbered);
  if (heights_mm.back() < kLeastHeight * step_mm || !fit_on_a_line(heights_mm, 0.5 * step_mm)) return false;
  if (at_one_place && have_equal_counts(heights_mm)) {
    throw InputError(subject,
                     fmt::format("{} and {} are at one position: positions are rounded to {:.4g} mm, or "
                                 "there are several images of each position",
                                 slices[numbered.order[0]].name, slices[numbered.order[1]].name, step_mm));
  }
  stack = std::move(numbered);
  stack.warnings.push_back(
      fmt::format("its positions are rounded to {:.4g} mm: slices were ordered by number, {:.6g} mm apart",
                  step_mm, heights_mm.back() / static_cast<double>(heights_mm.size() - 1)));
  return true;
}

// Drops copies. Returns whether the slices, in order of their numbers, fit an even grid with rounded
// positions.
bool resolve_positions(const std::string& subject, std::span<const SlicePlane> slices, const Vec3& normal,
                       const SamePixels& same_pixels, SliceStack& stack) {
  const auto is_same_instance = [&](std::size_t a, std::size_t b) {
    return !slices[a].instance.empty() && slices[a].instance == slices[b].instance;
  };
  std::optional<std::pair<std::size_t, std::size_t>> others;
  const auto are_on_rounded_grid = [&] {
    const std::vector<double> heights_mm = heights_of(slices, normal, stack);
    return (others || !are_even(heights_mm, gaps_between(heights_mm))) &&
           are_rounded(subject, slices, normal, others.has_value(), stack);
  };
  others = drop_copies(slices, normal, is_same_instance, stack);
  if (are_on_rounded_grid()) return true;
  // Pixels are compared last, because two empty slices may have been rounded to one position.
  if (others && same_pixels) {
    others = drop_copies(slices, normal, same_pixels, stack);
    if (are_on_rounded_grid()) return true;
  }
  if (others) {
    throw InputError(subject, fmt::format("{} and {} are different images at one position",
                                          slices[others->first].name, slices[others->second].name));
  }
  return false;
}

// Next to a missing slice, gaps are smaller on both sides; after a change of the table feed, the next gap is
// as wide.
bool slice_is_missing(std::span<const double> gaps_mm, std::size_t k) {
  double beside_mm = 0;
  if (k > 0) beside_mm = gaps_mm[k - 1];
  if (k + 1 < gaps_mm.size()) beside_mm = std::max(beside_mm, gaps_mm[k + 1]);
  return gaps_mm.size() > 1 && gaps_mm[k] > kMissing * beside_mm;
}

// Sets the grid's number of slices and their spacing.
void place_slices(const std::string& subject, std::span<const SlicePlane> slices, const Vec3& normal,
                  bool is_rounded, SliceStack& stack) {
  std::vector<double> heights_mm = heights_of(slices, normal, stack);
  const std::vector<double> gaps_mm = gaps_between(heights_mm);
  const auto between = [&](std::size_t k) {
    return fmt::format("{:.6g} mm between {} and {}", gaps_mm[k], slices[stack.order[k]].name,
                       slices[stack.order[k + 1]].name);
  };
  std::vector<double> sorted_mm = gaps_mm;
  std::sort(sorted_mm.begin(), sorted_mm.end());
  const bool even = is_rounded || are_even(heights_mm, gaps_mm);
  for (std::size_t k = 0; k < gaps_mm.size() && !even; ++k) {
    if (slice_is_missing(gaps_mm, k)) {
      throw InputError(subject, fmt::format("a slice is missing: {}, {:.6g} mm usually", between(k),
                                            sorted_mm[(sorted_mm.size() - 1) / 2]));
    }
    if (gaps_mm[k] > kMaxUnevenGap_mm) {
      throw InputError(subject,
                       fmt::format("slices are uneven, with a gap too wide to interpolate: {}", between(k)));
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
      fmt::format("slices are uneven, {:.6g} to {}: interpolated to {} slices {:.6g} mm apart",
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
      throw InputError(subject, slices[n].name + " is to the side of the other slices");
    }
  }
  if (std::abs(climb_mm.x()) > kSidewaysTolerance * spacing_mm.x() ||
      std::abs(climb_mm.y()) > kSidewaysTolerance * spacing_mm.y()) {
    stack.drift_i_mm = climb_mm.x() / (stack.geometry.dims[2] - 1);
    stack.drift_j_mm = climb_mm.y() / (stack.geometry.dims[2] - 1);
  }
}

// Interpolates between two densities; one of zero weight may be NaN.
double mixed(double one, double other, double share) {
  if (share == 0) return one;
  return share == 1 ? other : (1 - share) * one + share * other;
}

// Shift of a slice: whole pixels, and the remaining fraction.
struct Shift {
  int whole;
  double fraction;
};

Shift shift_of(double pixels) {
  const double whole = std::floor(pixels + 1e-9);
  return {static_cast<int>(whole), std::max(0.0, pixels - whole)};
}

}  // namespace

const char* difference_of(const SlicePlane& one, const SlicePlane& other) {
  if (one.columns != other.columns || one.rows != other.rows) return "size";
  const auto differ = [](double a, double b) { return std::abs(a - b) > kSpacingTolerance * std::abs(a); };
  if (differ(one.column_distance_mm, other.column_distance_mm) ||
      differ(one.row_distance_mm, other.row_distance_mm))
    return "pixel spacing";
  if ((one.i_direction - other.i_direction).norm() > 2 * kDirectionTolerance ||
      (one.j_direction - other.j_direction).norm() > 2 * kDirectionTolerance)
    return "orientation";
  return nullptr;
}

SliceStack stack_slices(const std::string& subject, std::span<const SlicePlane> slices,
                        const SamePixels& same_pixels) {
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
  const bool is_rounded = resolve_positions(subject, slices, normal, same_pixels, stack);
  if (stack.order.size() < 2) {
    throw InputError(subject, "only one slice: a volume needs at least two, to know their distance");
  }
  const SlicePlane& lowest = slices[stack.order.front()];
  stack.geometry.dims = {lowest.columns, lowest.rows, 0};
  stack.geometry.spacing_mm = {lowest.column_distance_mm, lowest.row_distance_mm, 0};
  stack.geometry.origin_mm = lowest.position_mm;
  place_slices(subject, slices, normal, is_rounded, stack);
  check_plausible(subject, stack.geometry);
  find_drift(subject, slices, stack);
  return stack;
}

void resample_to_even_slices(SliceStack& stack, std::vector<float>& densities) {
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
      even.push_back(
          static_cast<float>(mixed(static_cast<double>(lower[n]), static_cast<double>(upper[n]), share)));
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
                     fmt::format("slices lean by {:.1f} degrees, more than any gantry tilts", tilt_deg));
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
                     fmt::format("slices lean by {:.1f} degrees, too far to straighten them", tilt_deg));
  }
  float outside = std::numeric_limits<float>::max();
  for (const float density : densities) outside = std::min(outside, density);
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
             const double here = mixed(at(i, j), at(i - 1, j), a);
             const double above = mixed(at(i, j - 1), at(i - 1, j - 1), a);
             moved.push_back(static_cast<float>(mixed(here, above, b)));
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
