#include "osteomill/milling/burr_reach.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace osteomill {

namespace {

// The cells of all voxel centres in a ball lie in the ball grown by half a cell's diagonal.
std::size_t most_voxels_in_ball(const GridGeometry& geometry, double radius_mm) {
  const double grown_mm = radius_mm + 0.5 * geometry.spacing_mm.norm();
  const double most =
      4.0 / 3.0 * std::numbers::pi * grown_mm * grown_mm * grown_mm / geometry.voxel_volume_mm3();
  return static_cast<std::size_t>(std::min(most + 1, static_cast<double>(geometry.voxel_count())));
}

std::size_t most_across(const GridGeometry& geometry, double radius_mm, int axis) {
  const double across = 2 * radius_mm / geometry.spacing_mm[axis] + 2;
  const int dim = geometry.dims[static_cast<std::size_t>(axis)];
  return static_cast<std::size_t>(std::min(across, static_cast<double>(dim)));
}

std::size_t length(int first, int last) {
  return static_cast<std::size_t>(std::max(0, last - first + 1));
}

}  // namespace

BurrReach::BurrReach(const GridGeometry& geometry, double radius_mm, float floor_density)
    : geometry_(geometry),
      inverse_spacing_(geometry.spacing_mm.cwiseInverse()),
      radius_mm_(radius_mm),
      floor_density_(floor_density) {
  const std::size_t voxels = most_voxels_in_ball(geometry, radius_mm);
  const std::size_t rows = most_across(geometry, radius_mm, 1) * most_across(geometry, radius_mm, 2);
  for (Found* found : {&before_, &found_}) {
    found->rows.reserve(rows);
    found->looked_at.resize(rows);
    // One more than there can be: a voxel is written down before it is known to count.
    found->columns.resize(voxels + 1);
  }
  across2_mm2_.resize(voxels + 1);
  depths_mm_.resize(voxels + 1);
  densities_.resize(voxels + 1);
}

void BurrReach::find(const Volume& volume, const Vec3& centre_W) {
  std::swap(before_, found_);
  if (known_volume_ != &volume) before_.js = before_.ks = {};
  known_volume_ = &volume;
  next_before_ = before_.ks.last < before_.ks.first ? before_.rows.size() : 0;
  found_.rows.clear();
  found_.size = 0;

  const Vec3 centre_mm = geometry_.direction.transpose() * (centre_W - geometry_.origin_mm);
  found_.ks = span_within(centre_mm.z(), radius_mm_, 2);
  found_.js = span_within(centre_mm.y(), radius_mm_, 1);
  Span* looked_at = found_.looked_at.data();
  for (int k = found_.ks.first; k <= found_.ks.last; ++k) {
    const double z = k * geometry_.spacing_mm.z() - centre_mm.z();
    for (int j = found_.js.first; j <= found_.js.last; ++j, ++looked_at) {
      const double y = j * geometry_.spacing_mm.y() - centre_mm.y();
      const double across2 = y * y + z * z;
      const double half2 = radius_mm_ * radius_mm_ - across2;
      *looked_at = half2 > 0 ? span_within(centre_mm.x(), std::sqrt(half2), 0) : Span{};
      if (looked_at->last < looked_at->first) continue;
      find_row(volume.grid().densities().data() + volume.grid().linear_index({0, j, k}), *looked_at, j, k,
               across2);
    }
  }
  measure_depths(centre_mm.x());
}

// Clamped to the grid before the conversion to int, which truncates: std::floor and std::ceil are library
// calls on plain x86-64, and there are thousands of rows.
BurrReach::Span BurrReach::span_within(double centre_mm, double half_width_mm, int axis) const {
  const double count = geometry_.dims[static_cast<std::size_t>(axis)];
  const double first = (centre_mm - half_width_mm) * inverse_spacing_[axis];
  const double last = (centre_mm + half_width_mm) * inverse_spacing_[axis];
  const double first_inside = std::min(std::max(first, 0.0), count);
  const double last_inside = std::min(std::max(last, -1.0), count - 1);
  Span span{static_cast<int>(first_inside), static_cast<int>(last_inside + 1) - 1};
  if (static_cast<double>(span.first) < first_inside) ++span.first;
  return span;
}

BurrReach::Span BurrReach::looked_at_before(int j, int k) const {
  if (j < before_.js.first || j > before_.js.last || k < before_.ks.first || k > before_.ks.last) return {};
  const std::size_t row = length(before_.ks.first, k - 1) * length(before_.js.first, before_.js.last) +
                          length(before_.js.first, j - 1);
  return before_.looked_at[row];
}

void BurrReach::find_row(const float* densities, Span row, int j, int k, double across2) {
  const std::size_t begin = found_.size;
  const Span known = looked_at_before(j, k);
  if (known.last < known.first) {
    look_at(densities, row);
  } else {
    look_at(densities, {row.first, std::min(row.last, known.first - 1)});
    look_again(densities, row, j, k);
    look_at(densities, {std::max(row.first, known.last + 1), row.last});
  }
  if (found_.size == begin) return;
  found_.rows.push_back({j, k, begin, found_.size});
  std::fill(across2_mm2_.begin() + static_cast<std::ptrdiff_t>(begin),
            across2_mm2_.begin() + static_cast<std::ptrdiff_t>(found_.size), static_cast<float>(across2));
}

void BurrReach::look_at(const float* densities, Span columns) {
  std::size_t size = found_.size;
  for (int i = columns.first; i <= columns.last; ++i) {
    found_.columns[size] = i;
    densities_[size] = densities[i];
    size += densities[i] > floor_density_ ? 1 : 0;
  }
  found_.size = size;
}

void BurrReach::look_again(const float* densities, Span columns, int j, int k) {
  const std::vector<Row>& rows = before_.rows;
  while (next_before_ < rows.size() &&
         (rows[next_before_].k < k || (rows[next_before_].k == k && rows[next_before_].j < j))) {
    ++next_before_;
  }
  if (next_before_ == rows.size() || rows[next_before_].k != k || rows[next_before_].j != j) return;
  std::size_t size = found_.size;
  for (std::size_t n = rows[next_before_].begin; n < rows[next_before_].end; ++n) {
    const int i = before_.columns[n];
    found_.columns[size] = i;
    densities_[size] = densities[i];
    size += densities[i] > floor_density_ && i >= columns.first && i <= columns.last ? 1 : 0;
  }
  found_.size = size;
}

void BurrReach::measure_depths(double centre_i_mm) {
  // Columns from the middle of those found, so that single precision is spent within the ball.
  const int middle = found_.size > 0 ? found_.columns[0] : 0;
  const float centre_mm = static_cast<float>(centre_i_mm - middle * geometry_.spacing_mm.x());
  const float spacing_mm = static_cast<float>(geometry_.spacing_mm.x());
  const float radius_mm = static_cast<float>(radius_mm_);
  const int* columns = found_.columns.data();
  for (std::size_t n = 0; n < found_.size; ++n) {
    const float x = static_cast<float>(columns[n] - middle) * spacing_mm - centre_mm;
    depths_mm_[n] = std::max(0.0f, radius_mm - std::sqrt(across2_mm2_[n] + x * x));
  }
}

}  // namespace osteomill
