#include "osteomill/volume/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace osteomill {

namespace {

struct Cell {
  VoxelIndex first;
  Vec3 fraction;
  bool far_outside = false;
};

// Floor of a number in the range of int; std::floor is a library call on baseline x86-64.
int floor_of(double value) {
  const int truncated = static_cast<int>(value);
  return truncated - (static_cast<double>(truncated) > value ? 1 : 0);
}

// Cell of eight voxel centres around a point. Also covers coordinates beyond the range of int: these are far
// outside.
Cell cell_around(const DensityGrid& grid, const Vec3& voxel) {
  const auto& dims = grid.geometry().dims;
  const double x = voxel.x(), y = voxel.y(), z = voxel.z();
  Cell cell;
  cell.far_outside = !(x > -1.0 && x < dims[0] && y > -1.0 && y < dims[1] && z > -1.0 && z < dims[2]);
  if (cell.far_outside) return cell;
  cell.first = {floor_of(x), floor_of(y), floor_of(z)};
  cell.fraction = {x - cell.first.i, y - cell.first.j, z - cell.first.k};
  return cell;
}

double interpolate(double a, double b, double fraction) {
  return a + fraction * (b - a);
}

// Each pointer refers to a pair of corners adjacent along i; the pairs are ordered j before k.
inline double interpolate_cell(const float* pair00, const float* pair10, const float* pair01,
                               const float* pair11, double fx, double fy, double fz) {
  const auto along_i = [fx](const float* pair) { return interpolate(pair[0], pair[1], fx); };
  return interpolate(interpolate(along_i(pair00), along_i(pair10), fy),
                     interpolate(along_i(pair01), along_i(pair11), fy), fz);
}

// Returns the corners of a cell that is not entirely inside the grid.
std::array<float, 8> cell_corners(const DensityGrid& grid, const VoxelIndex& c) {
  std::array<float, 8> corner;
  for (int n = 0; n < 8; ++n) {
    corner[static_cast<std::size_t>(n)] =
        grid.at_or_outside({c.i + (n & 1), c.j + ((n >> 1) & 1), c.k + (n >> 2)});
  }
  return corner;
}

// Weights of four consecutive voxels for a point at fraction `f` between the middle two.
using Weights = std::array<double, 4>;

Weights difference_weights(double f) {
  return {-0.5 * (1 - f), -0.5 * f, 0.5 * (1 - f), 0.5 * f};
}
Weights smoothing_weights(double f) {
  return {(1 - f) * 3 / 16, ((1 - f) * 10 + f * 3) / 16, ((1 - f) * 3 + f * 10) / 16, f * 3 / 16};
}

// The 4 x 4 x 4 voxels around a cell, i fastest.
using Block = std::array<float, 64>;

Block voxels_around(const DensityGrid& grid, const VoxelIndex& cell) {
  Block block;
  const VoxelIndex first{cell.i - 1, cell.j - 1, cell.k - 1};
  const bool interior = grid.contains(first) && grid.contains({cell.i + 2, cell.j + 2, cell.k + 2});
  std::size_t n = 0;
  for (int k = 0; k < 4; ++k) {
    for (int j = 0; j < 4; ++j) {
      const VoxelIndex row{first.i, first.j + j, first.k + k};
      if (interior) {
        const float* density = grid.address_of(row);
        for (int i = 0; i < 4; ++i) block[n++] = density[i];
      } else {
        for (int i = 0; i < 4; ++i) block[n++] = grid.at_or_outside({row.i + i, row.j, row.k});
      }
    }
  }
  return block;
}

constexpr double kFlatGradient = 1e-9;  // density per mm

struct Span {
  double first = 0.0;
  double last = 1.0;
};

// Clips a line in voxel coordinates to the grid plus a margin of one voxel, in which the density still falls.
// Returns fractions of `path`; first > last if the line misses it.
Span span_in_grid(const GridGeometry& geometry, const Vec3& from, const Vec3& path) {
  Span span;
  for (int axis = 0; axis < 3; ++axis) {
    const double min = -1.0;
    const double max = geometry.dims[static_cast<std::size_t>(axis)];
    if (path[axis] == 0.0) {
      if (from[axis] < min || from[axis] > max) return {1.0, 0.0};
      continue;
    }
    const double a = (min - from[axis]) / path[axis];
    const double b = (max - from[axis]) / path[axis];
    span.first = std::max(span.first, std::min(a, b));
    span.last = std::min(span.last, std::max(a, b));
  }
  return span;
}

}  // namespace

double density_at_voxel(const DensityGrid& grid, const Vec3& voxel) noexcept {
  const auto& dims = grid.geometry().dims;
  const double x = voxel.x(), y = voxel.y(), z = voxel.z();
  if (x >= 0 && y >= 0 && z >= 0 && x < dims[0] - 1 && y < dims[1] - 1 && z < dims[2] - 1) {
    // Common case: the whole cell is in the grid.
    const VoxelIndex c{static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
    const float* row = grid.address_of(c);
    const float* next = row + grid.slice_stride();
    return interpolate_cell(row, row + grid.row_stride(), next, next + grid.row_stride(), x - c.i, y - c.j,
                            z - c.k);
  }
  const Cell cell = cell_around(grid, voxel);
  if (cell.far_outside) return grid.outside_density();
  const std::array<float, 8> corner = cell_corners(grid, cell.first);
  const Vec3& f = cell.fraction;
  return interpolate_cell(&corner[0], &corner[2], &corner[4], &corner[6], f.x(), f.y(), f.z());
}

double density_at(const DensityGrid& grid, const Vec3& point_W) noexcept {
  return density_at_voxel(grid, grid.geometry().voxel_from_world(point_W));
}

Vec3 density_gradient(const DensityGrid& grid, const Vec3& point_W) noexcept {
  const GridGeometry& geometry = grid.geometry();
  const Cell cell = cell_around(grid, geometry.voxel_from_world(point_W));
  if (cell.far_outside) return Vec3::Zero();
  const Block block = voxels_around(grid, cell.first);

  std::array<Weights, 3> difference;
  std::array<Weights, 3> across;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double f = cell.fraction[static_cast<Eigen::Index>(axis)];
    difference[axis] = difference_weights(f);
    across[axis] = smoothing_weights(f);
  }
  Vec3 gradient_voxel = Vec3::Zero();
  std::size_t n = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    double slice_di = 0, slice_dj = 0, slice_dk = 0;
    for (std::size_t j = 0; j < 4; ++j) {
      double row_difference = 0, row_value = 0;
      for (std::size_t i = 0; i < 4; ++i, ++n) {
        const double density = static_cast<double>(block[n]);
        row_difference += difference[0][i] * density;
        row_value += across[0][i] * density;
      }
      slice_di += across[1][j] * row_difference;
      slice_dj += difference[1][j] * row_value;
      slice_dk += across[1][j] * row_value;
    }
    gradient_voxel += Vec3(across[2][k] * slice_di, across[2][k] * slice_dj, difference[2][k] * slice_dk);
  }
  return geometry.direction * gradient_voxel.cwiseQuotient(geometry.spacing_mm);
}

int count_in_bone(const Volume& volume, std::span<const Vec3> points_T, const Pose& X_WT) noexcept {
  return static_cast<int>(std::count_if(points_T.begin(), points_T.end(), [&](const Vec3& point_T) {
    return is_bone_at(volume, X_WT * point_T);
  }));
}

std::optional<Vec3> outward_normal(const Volume& volume, const Vec3& point_W) noexcept {
  const Vec3 gradient = density_gradient(volume.grid(), point_W);
  const double steepness = gradient.norm();
  if (!(steepness > kFlatGradient)) return std::nullopt;
  return -gradient / steepness;
}

Vec3 bisect_crossing(const Volume& volume, Vec3 outside_W, Vec3 inside_W, double tolerance_mm) noexcept {
  for (int n = 0; n < 60 && (inside_W - outside_W).norm() > tolerance_mm; ++n) {
    const Vec3 middle = 0.5 * (outside_W + inside_W);
    (is_bone_at(volume, middle) ? inside_W : outside_W) = middle;
  }
  return outside_W;
}

std::optional<Vec3> first_crossing(const Volume& volume, const Vec3& from_W, const Vec3& to_W) noexcept {
  if (is_bone_at(volume, from_W)) return from_W;
  const GridGeometry& geometry = volume.geometry();
  const Vec3 path = (geometry.direction.transpose() * (to_W - from_W)).cwiseQuotient(geometry.spacing_mm);
  const Span span = span_in_grid(geometry, geometry.voxel_from_world(from_W), path);
  if (!(span.first <= span.last)) return std::nullopt;
  const double steps = std::max(1.0, std::ceil(2 * path.norm()));
  const auto at = [&](double n) { return Vec3(from_W + (n / steps) * (to_W - from_W)); };
  const double first = std::max(1.0, std::floor(span.first * steps));
  const double last = std::min(steps, std::ceil(span.last * steps));
  // Bounds the loop: for very distant points, rounding makes the number of steps unreliable.
  const int most = 4 + 2 * (geometry.dims[0] + geometry.dims[1] + geometry.dims[2] + 3);
  Vec3 before = at(first - 1);
  for (int n = 0; n < most && first + n <= last; ++n) {
    const Vec3 here = at(first + n);
    if (is_bone_at(volume, here)) return bisect_crossing(volume, before, here);
    before = here;
  }
  return std::nullopt;
}

}  // namespace osteomill
