#pragma once

#include <optional>

#include "osteomill/volume/sampling.h"
#include "osteomill/volume/volume.h"

/// Where the bone's surface is, which way it faces, and how a point follows it. Safe in the haptic tick, for
/// any finite points.
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

/// The 3-DOF point proxy on the isosurface: a point that follows a probe but never enters the bone. The paper
/// takes it from earlier work without describing it; this is the usual one (Zilles and Salisbury 1995,
/// Ruspini 1997) on an isosurface. It repeats two moves:
/// - it marches straight toward the probe until bone is in the way, also where milling has taken the bone
///   from under it;
/// - it slides in the tangent plane toward the point nearest to the probe, at most a voxel, and comes back to
///   the isosurface along the normal.
///
/// It rests where the line to the probe is within the cone of friction about the surface's normal (Harwin and
/// Melder 2002): `friction` is the coefficient, 0 for none. The answer is the probe itself where the way to
/// it is free. A proxy that starts in bone is first brought out along the normal; where that fails it stays.
Vec3 move_point_proxy(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W,
                      const NormalRule& normal, double friction);

}  // namespace osteomill::line_proxy
