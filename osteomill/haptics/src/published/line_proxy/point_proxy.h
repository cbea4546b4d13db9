#pragma once

#include <optional>

#include "osteomill/volume/volume.h"

/// The bone's surface and a point proxy on it. Safe in the haptic tick, for any finite points.
namespace osteomill::line_proxy {

/// Returns the nearest point just outside the bone, among 26 directions and up to `reach_mm`; `point_W`
/// itself if it is not in bone; nothing if no exit is found.
std::optional<Vec3> nearest_exit(const Volume& volume, const Vec3& point_W, double reach_mm);

/// Returns the outward unit normal of the bone at a point, or nothing if the density is flat there. The paper
/// does not specify its gradients. Here the normal opposes the sum of eight smoothed gradients around the
/// point: on an oblique plane, central differences deviate with the grid by several degrees, this sum by less
/// than half a degree.
std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W);

/// Moves the 3-DOF point proxy on the isosurface: a point that follows a probe but never enters the bone. The
/// paper takes it from earlier work without describing it; this is the usual one (Zilles and Salisbury 1995,
/// Ruspini 1997) on an isosurface, without friction. It repeats two moves:
/// - march straight toward the probe until bone blocks the way, also after milling has removed the bone under
///   the proxy;
/// - slide in the tangent plane toward the point nearest to the probe, at most one voxel, and return to the
///   isosurface along the normal.
///
/// Returns the probe itself if the way to it is free. A proxy that starts in bone is first moved out along
/// the normal; if that fails, it stays.
Vec3 move_point_proxy(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W);

}  // namespace osteomill::line_proxy
