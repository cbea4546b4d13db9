#pragma once

#include <optional>

#include "osteomill/volume/volume.h"

/// The bone's surface, and how a point follows it. Safe in the haptic tick, for any finite points.
namespace osteomill::line_proxy {

/// Returns the point just outside the bone nearest to `point_W`, among 26 directions and up to `reach_mm`;
/// `point_W` itself if it is not in bone.
std::optional<Vec3> nearest_exit(const Volume& volume, const Vec3& point_W, double reach_mm);

/// Returns the unit vector out of the bone at a point, or nothing if the density is flat there. The paper
/// does not say how it takes gradients. Here the normal is against the sum of eight smoothed gradients about
/// the point: central differences turn with the grid by several degrees on an oblique plane, this sum by less
/// than half of one.
std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W);

/// Moves the 3-DOF point proxy on the isosurface: a point that follows a probe but never enters the bone. The
/// paper takes it from earlier work without describing it; this is the usual one (Zilles and Salisbury 1995,
/// Ruspini 1997) on an isosurface, without friction. It repeats two moves:
/// - it marches straight toward the probe until bone is in the way, also if milling has taken the bone from
///   under it;
/// - it slides in the tangent plane toward the point nearest to the probe, at most a voxel, and comes back to
///   the isosurface along the normal.
///
/// The answer is the probe itself if the way to it is free. A proxy that starts in bone is first brought out
/// along the normal; if that fails it stays.
Vec3 move_point_proxy(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W);

}  // namespace osteomill::line_proxy
