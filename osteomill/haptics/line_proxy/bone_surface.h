#pragma once

#include <optional>

#include "osteomill/volume/sampling.h"
#include "osteomill/volume/volume.h"

/// Where the bone's surface is, and which way it faces. Safe in the haptic tick, for any finite points.
namespace osteomill::line_proxy {

/// The point just outside the bone nearest to `point_W`, among 26 directions and up to `reach_mm`; `point_W`
/// itself where it is not in bone.
std::optional<Vec3> nearest_exit(const Volume& volume, const Vec3& point_W, double reach_mm);

/// How far from a point in bone along the unit vector `out_W` the bone ends; nothing beyond `reach_mm`, or
/// where that vector is zero.
std::optional<double> depth_along(const Volume& volume, const Vec3& point_W, const Vec3& out_W,
                                  double reach_mm);

/// How the normal of the isosurface is found.
struct NormalRule {
  GradientKernel kernel = GradientKernel::smoothed;
  /// 0 takes the gradient at the point alone; otherwise the sum of eight, at the corners of a cube this far
  /// (in voxels) from it, which quarters the turning of the normal with the grid.
  double spread_voxels = 1.25;
};

/// The unit vector out of the bone at a point, or nothing where the density is flat.
std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W, const NormalRule& rule);

}  // namespace osteomill::line_proxy
