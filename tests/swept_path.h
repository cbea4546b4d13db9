#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "osteomill/volume/sampling.h"
#include "osteomill/volume/volume.h"

namespace osteomill::testing_support {

/// Brute-force reference of the volume swept by a ball: the signed distance, on a lattice of points, to the
/// union of balls around all centres of a path.
class SweptPath {
 public:
  /// Builds a lattice of points `spacing_mm` apart around the whole path.
  SweptPath(const std::vector<Vec3>& centres_W, double radius_mm, double spacing_mm)
      : radius_mm_(radius_mm), spacing_mm_(spacing_mm), first_W_(centres_W.at(0)) {
    Vec3 last_W = first_W_;
    for (const Vec3& centre_W : centres_W) {
      first_W_ = first_W_.cwiseMin(centre_W);
      last_W = last_W.cwiseMax(centre_W);
    }
    first_W_.array() -= radius_mm + kMargin_mm;
    last_W.array() += radius_mm + kMargin_mm;
    for (int axis = 0; axis < 3; ++axis) {
      dims_[axis] = static_cast<int>(std::ceil((last_W[axis] - first_W_[axis]) / spacing_mm)) + 1;
    }
    distances_mm_.assign(static_cast<std::size_t>(dims_[0]) * static_cast<std::size_t>(dims_[1]) *
                             static_cast<std::size_t>(dims_[2]),
                         kFar_mm);
    // Between centres this close, ridges of the union of balls, a^2 / 8 r high, are negligible.
    const double apart_mm = std::sqrt(0.002 * radius_mm);
    Vec3 before_W = centres_W.front();
    add(before_W);
    for (const Vec3& centre_W : centres_W) {
      if ((centre_W - before_W).norm() < apart_mm && &centre_W != &centres_W.back()) continue;
      add(before_W = centre_W);
    }
  }

  template <typename Visit>
  void for_each_point(const Visit& visit) const {
    std::size_t n = 0;
    for (int k = 0; k < dims_[2]; ++k)
      for (int j = 0; j < dims_[1]; ++j)
        for (int i = 0; i < dims_[0]; ++i) visit(point_W(i, j, k), static_cast<double>(distances_mm_[n++]));
  }
  /// Returns the distance at the nearest lattice point, clamped to twice the margin.
  double distance_mm(const Vec3& point_W) const {
    std::size_t at[3];
    for (int axis = 0; axis < 3; ++axis) {
      const auto n = std::lround((point_W[axis] - first_W_[axis]) / spacing_mm_);
      at[axis] = static_cast<std::size_t>(std::clamp<long>(n, 0, dims_[axis] - 1));
    }
    return static_cast<double>(
        distances_mm_[at[0] + static_cast<std::size_t>(dims_[0]) *
                                  (at[1] + static_cast<std::size_t>(dims_[1]) * at[2])]);
  }
  double point_mm3() const { return spacing_mm_ * spacing_mm_ * spacing_mm_; }

 private:
  static constexpr double kMargin_mm = 0.6;
  static constexpr float kFar_mm = 2 * static_cast<float>(kMargin_mm);

  Vec3 point_W(int i, int j, int k) const { return first_W_ + spacing_mm_ * Vec3(i, j, k); }
  void add(const Vec3& centre_W) {
    const double reach_mm = radius_mm_ + kMargin_mm;
    int from[3], to[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double at = (centre_W[axis] - first_W_[axis]) / spacing_mm_;
      from[axis] = std::max(0, static_cast<int>(std::ceil(at - reach_mm / spacing_mm_)));
      to[axis] = std::min(dims_[axis] - 1, static_cast<int>(std::floor(at + reach_mm / spacing_mm_)));
    }
    for (int k = from[2]; k <= to[2]; ++k)
      for (int j = from[1]; j <= to[1]; ++j) {
        float* row = &distances_mm_[static_cast<std::size_t>(dims_[0]) *
                                    (static_cast<std::size_t>(j) +
                                     static_cast<std::size_t>(dims_[1]) * static_cast<std::size_t>(k))];
        const Vec3 start = point_W(0, j, k) - centre_W;
        const double across2 = start.y() * start.y() + start.z() * start.z();
        for (int i = from[0]; i <= to[0]; ++i) {
          const double x = start.x() + spacing_mm_ * i;
          row[i] = std::min(row[i], static_cast<float>(std::sqrt(x * x + across2) - radius_mm_));
        }
      }
  }

  double radius_mm_;
  double spacing_mm_;
  Vec3 first_W_;
  int dims_[3] = {};
  std::vector<float> distances_mm_;
};

/// Compares the cut with the swept volume by the interpolated densities, which define the drawn and felt
/// surface. Ignores points within two voxels of the earlier surface, because voxels round the edge at the
/// cut's rim. Counts edges between two passes separately.
struct Carving {
  double swept_mm3 = 0;
  double carved_mm3 = 0;
  /// Largest depth inside the swept volume at which bone remains.
  double left_mm = 0;
  /// Largest distance outside the swept volume at which bone was removed: beside a smooth swept surface, and
  /// at edges between two passes.
  double lost_mm = 0;
  double edge_lost_mm = 0;

  double share() const { return swept_mm3 > 0 ? carved_mm3 / swept_mm3 : 0.0; }
};

inline bool is_deep_in_bone(const Volume& volume, const Vec3& point_W) {
  const GridGeometry& geometry = volume.geometry();
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 voxel_W = geometry.spacing_mm[axis] * geometry.direction.col(axis);
    for (const double side : {-2.0, 0.0, 2.0}) {
      if (!(density_at(volume.grid(), point_W + side * voxel_W) > volume.isovalue())) return false;
    }
  }
  return true;
}

/// Returns whether the point is at an edge between two swept surfaces: the gradient of the distance, by
/// central differences over one voxel, is then shorter than 1.
inline bool is_at_edge(const SweptPath& path, const GridGeometry& geometry, const Vec3& point_W) {
  constexpr double kMinSlope = 0.97, kMaxSpacing_mm = 0.25;
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 aside_W = std::min(geometry.spacing_mm.maxCoeff(), kMaxSpacing_mm) * Vec3::Unit(axis);
    slope[axis] =
        (path.distance_mm(point_W + aside_W) - path.distance_mm(point_W - aside_W)) / (2 * aside_W.norm());
  }
  return slope.norm() < kMinSlope;
}

inline Carving carving(const Volume& before, const Volume& after, const SweptPath& path) {
  Carving result;
  path.for_each_point([&](const Vec3& point_W, double distance_mm) {
    const bool bone = density_at(after.grid(), point_W) > after.isovalue();
    if ((bone && distance_mm >= 0) || !is_deep_in_bone(before, point_W)) return;
    if (distance_mm < 0) result.swept_mm3 += path.point_mm3();
    if (!bone) result.carved_mm3 += path.point_mm3();
    if (bone) result.left_mm = std::max(result.left_mm, -distance_mm);
    if (bone || distance_mm <= std::min(result.lost_mm, result.edge_lost_mm)) return;
    double& lost_mm = is_at_edge(path, before.geometry(), point_W) ? result.edge_lost_mm : result.lost_mm;
    lost_mm = std::max(lost_mm, distance_mm);
  });
  return result;
}

}  // namespace osteomill::testing_support
