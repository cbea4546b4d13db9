#pragma once

#include <optional>

#include "osteomill/volume/sampling.h"

/// Marching from and to bone. Safe in the haptic tick, for any finite points: the time is bounded by the size
/// of the grid, not by how far apart the points are.
namespace osteomill::line_proxy {

/// As osteomill::first_crossing, but walks only the part of the segment that lies in the grid.
std::optional<Vec3> crossing_in_grid(const Volume& volume, const Vec3& from_W, const Vec3& to_W);

/// The point just outside the bone nearest to `point_W`, among 26 directions and up to `reach_mm`; `point_W`
/// itself where it is not in bone.
std::optional<Vec3> nearest_exit(const Volume& volume, const Vec3& point_W, double reach_mm);

}  // namespace osteomill::line_proxy
