#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "osteomill/ct/slice_stack.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

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

namespace {

// Gantries tilt by 30 degrees at most.
constexpr double kMaxTilt_deg = 45.0;

// A slice as it was taken; beyond its border there is `outside`.
struct Slice {
  const float* pixels;
  int columns;
  int rows;
  float outside;

  double at(int i, int j) const {
    const bool inside = i >= 0 && j >= 0 && i < columns && j < rows;
    const auto index =
        static_cast<std::size_t>(j) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(i);
    return static_cast<double>(inside ? pixels[index] : outside);
  }
};

// Where a moved slice begins, in whole pixels and the fraction by which it lies further.
struct Shift {
  int whole;
  double fraction;
};

Shift shift_of(double pixels) {
  const double whole = std::floor(pixels + 1e-9);
  return {static_cast<int>(whole), std::max(0.0, pixels - whole)};
}

// The slice, moved by the fractions, written with its first pixel at (`i`, `j`) of the larger slice.
void move_slice(const Slice& slice, const Shift& shift_i, const Shift& shift_j, int i, int j, int columns,
                float* moved) {
  const double a = shift_i.fraction;
  const double b = shift_j.fraction;
  for (int row = 0; row <= slice.rows; ++row) {
    for (int column = 0; column <= slice.columns; ++column) {
      if ((row == slice.rows && b == 0) || (column == slice.columns && a == 0)) continue;
      const double here = (1 - a) * slice.at(column, row) + a * slice.at(column - 1, row);
      const double above = (1 - a) * slice.at(column, row - 1) + a * slice.at(column - 1, row - 1);
      const auto index = static_cast<std::size_t>(j + row) * static_cast<std::size_t>(columns) +
                         static_cast<std::size_t>(i + column);
      moved[index] = static_cast<float>((1 - b) * here + b * above);
    }
  }
}

}  // namespace

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
  std::array<int, 2> size{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double drift = step[axis] * (count - 1);
    first[axis] = static_cast<int>(std::floor(std::min(0.0, drift)));
    size[axis] = geometry.dims[axis] + static_cast<int>(std::ceil(std::abs(drift)));
  }
  const std::size_t slice_size = static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]);
  if (slice_size * static_cast<std::size_t>(count) > 4 * densities.size()) {
    throw InputError(subject,
                     fmt::format("slices lean by {:.1f} degrees, too far to put them straight", tilt_deg));
  }
  const float outside = *std::min_element(densities.begin(), densities.end());
  std::vector<float> moved(slice_size * static_cast<std::size_t>(count), outside);
  const std::size_t old_size = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  for (int k = 0; k < count; ++k) {
    const Shift shift_i = shift_of(step[0] * k);
    const Shift shift_j = shift_of(step[1] * k);
    const Slice slice{densities.data() + static_cast<std::size_t>(k) * old_size, columns, rows, outside};
    move_slice(slice, shift_i, shift_j, shift_i.whole - first[0], shift_j.whole - first[1], size[0],
               moved.data() + static_cast<std::size_t>(k) * slice_size);
  }
  geometry.origin_mm = geometry.world_from_voxel(Vec3(first[0], first[1], 0));
  geometry.dims = {size[0], size[1], count};
  stack.drift_i_mm = stack.drift_j_mm = 0;
  stack.warnings.push_back(fmt::format(
      "the gantry was tilted by {:.1f} degrees: slices were shifted into a straight grid of {} x {} x {}",
      tilt_deg, size[0], size[1], count));
  densities = std::move(moved);
}

}  // namespace osteomill
