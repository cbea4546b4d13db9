#include "osteomill/volume/nearest_voxels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace osteomill {

namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();

// Parabola of the lower envelope: its vertex, the height there, and the last coordinate at which it is
// lowest.
struct Parabola {
  int foot = 0;
  float height = 0;
  double until = 0;
};

// Distance along an axis between voxels `apart` indices apart, in voxels.
double counted(int apart, NearestVoxels::To to) {
  return to == NearestVoxels::To::centres ? apart : std::max(0.0, std::abs(apart) - 0.5);
}

// Returns the coordinate from which a parabola is lower than an earlier one. For `To::faces`, a parabola is
// flat within half a voxel of its vertex and shifted outwards by half a voxel beyond: between their vertices
// the two intersect as if these were one voxel closer together.
double crossing(const Parabola& before, int foot, float height, double step_mm, NearestVoxels::To to) {
  const int apart = foot - before.foot;
  const double rise =
      0.5 * (static_cast<double>(height) - static_cast<double>(before.height)) / (step_mm * step_mm);
  const double middle = 0.5 * (foot + before.foot);
  if (to == NearestVoxels::To::centres) return middle + rise / apart;
  const double squares = 2 * std::abs(rise);
  if (squares <= (apart - 1) * (apart - 1)) return apart > 1 ? middle + rise / (apart - 1) : middle;
  if (squares >= apart * apart) return middle + std::copysign(0.5, rise) + rise / apart;
  const double beside = 0.5 + std::sqrt(squares);
  return rise > 0 ? before.foot + beside : foot - beside;
}

}  // namespace

NearestVoxels::NearestVoxels(const VoxelSet& set, const VoxelBox& box, const Vec3& spacing_mm, To to)
    : box_(box), spacing_mm_(spacing_mm) {
  if (box.empty()) return;
  dims_ = box.dims();
  const std::size_t count = cell_count(dims_);
  if (count > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw std::invalid_argument("NearestVoxels: the box holds too many voxels");
  nearest_.assign(count, -1);
  std::vector<float> squares_mm2(count, kInfinite);
  for_each(set.box().intersected(box), [&](const VoxelIndex& v) {
    if (!set.contains(v)) return;
    const std::size_t place = row_major(dims_, v.i - box.first.i, v.j - box.first.j, v.k - box.first.k);
    squares_mm2[place] = 0;
    nearest_[place] = static_cast<std::int32_t>(place);
    found_ = true;
  });
  for (std::size_t axis = 0; axis < 3 && found_; ++axis) sweep(axis, to, squares_mm2);
}

// One pass of the transform: replaces the squared distances along each line of the box by the lower envelope
// of the parabolas.
void NearestVoxels::sweep(std::size_t axis, To to, std::vector<float>& squares_mm2) {
  const std::size_t stride = axis == 0 ? 1
                             : axis == 1
                                 ? static_cast<std::size_t>(dims_[0])
                                 : static_cast<std::size_t>(dims_[0]) * static_cast<std::size_t>(dims_[1]);
  const int length = dims_[axis];
  const double step = spacing_mm_[static_cast<Eigen::Index>(axis)];
  std::vector<Parabola> envelope(static_cast<std::size_t>(length));
  std::vector<std::int32_t> before(static_cast<std::size_t>(length));
  VoxelBox starts{{0, 0, 0}, {dims_[0] - 1, dims_[1] - 1, dims_[2] - 1}};
  (axis == 0 ? starts.last.i : axis == 1 ? starts.last.j : starts.last.k) = 0;
  for_each(starts, [&](const VoxelIndex& start) {
    const std::size_t first = row_major(dims_, start.i, start.j, start.k);
    std::size_t parabolas = 0;
    for (int n = 0; n < length; ++n) {
      const std::size_t place = first + stride * static_cast<std::size_t>(n);
      before[static_cast<std::size_t>(n)] = nearest_[place];
      const float height = squares_mm2[place];
      if (height == kInfinite) continue;
      // Removes parabolas hidden by this one and finds where it becomes the lowest.
      double from = -1;
      while (parabolas > 0) {
        const Parabola& last = envelope[parabolas - 1];
        from = crossing(last, n, height, step, to);
        if (parabolas == 1 || from > envelope[parabolas - 2].until) break;
        --parabolas;
      }
      if (parabolas > 0) envelope[parabolas - 1].until = from;
      envelope[parabolas++] = {n, height, std::numeric_limits<double>::infinity()};
    }
    if (parabolas == 0) return;
    std::size_t at = 0;
    for (int n = 0; n < length; ++n) {
      while (envelope[at].until < n) ++at;
      const Parabola& lowest = envelope[at];
      const double apart_mm = step * counted(n - lowest.foot, to);
      const std::size_t place = first + stride * static_cast<std::size_t>(n);
      squares_mm2[place] = lowest.height + static_cast<float>(apart_mm * apart_mm);
      nearest_[place] = before[static_cast<std::size_t>(lowest.foot)];
    }
  });
}

VoxelIndex NearestVoxels::nearest_to(const VoxelIndex& v) const noexcept {
  const std::size_t place = row_major(dims_, v.i - box_.first.i, v.j - box_.first.j, v.k - box_.first.k);
  // 32-bit divisions are several times faster than 64-bit ones.
  const std::int32_t near = nearest_[place], row = near / dims_[0], layer = row / dims_[1];
  return {box_.first.i + near - row * dims_[0], box_.first.j + row - layer * dims_[1], box_.first.k + layer};
}

double NearestVoxels::distance_mm(const VoxelIndex& v) const noexcept {
  if (!found_) return std::numeric_limits<double>::infinity();
  const VoxelIndex n = nearest_to(v);
  return Vec3(v.i - n.i, v.j - n.j, v.k - n.k).cwiseProduct(spacing_mm_).norm();
}

}  // namespace osteomill
