#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "osteomill/volume/volume.h"

namespace osteomill::testing_support {

/// Returns bone of a known shape from `signed_distance_mm` (negative inside): densities 0 (outside) to 1000
/// (inside), with a linear edge `edge_voxels` wide across the surface, at which the density is the isovalue,
/// 500.
inline Volume shape_volume(const GridGeometry& geometry,
                           const std::function<double(const Vec3& point_W)>& signed_distance_mm,
                           double edge_voxels = 2.0) {
  const double edge_mm = edge_voxels * geometry.spacing_mm.minCoeff();
  std::vector<float> densities;
  densities.reserve(geometry.voxel_count());
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const double distance = signed_distance_mm(geometry.world_from_voxel(VoxelIndex{i, j, k}));
        densities.push_back(static_cast<float>(1000.0 * std::clamp(0.5 - distance / edge_mm, 0.0, 1.0)));
      }
    }
  }
  return Volume(DensityGrid(geometry, std::move(densities)), 500.0);
}

/// Returns a cubic grid of `voxels`^3 centred on the origin of W.
inline GridGeometry centred_cube(int voxels, double spacing_mm) {
  GridGeometry geometry;
  geometry.dims = {voxels, voxels, voxels};
  geometry.spacing_mm = Vec3::Constant(spacing_mm);
  geometry.origin_mm = Vec3::Constant(-0.5 * (voxels - 1) * spacing_mm);
  return geometry;
}

/// Returns the signed distance of the half-space below the plane through `point_W` with the outward `normal`.
inline std::function<double(const Vec3&)> plane(const Vec3& point_W, const Vec3& normal) {
  return [point_W, unit = normal.normalized().eval()](const Vec3& p) { return unit.dot(p - point_W); };
}

/// Returns the signed distance of a ball.
inline std::function<double(const Vec3&)> ball(const Vec3& centre_W, double radius_mm) {
  return [=](const Vec3& p) { return (p - centre_W).norm() - radius_mm; };
}

}  // namespace osteomill::testing_support
