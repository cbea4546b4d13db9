#pragma once

#include "osteomill/volume/volume.h"

namespace osteomill::surface_points {

/// Where the spring of (15) from a colliding vertex (density above the isovalue) to a free point (density at
/// or below it) meets the surface, if the density ran linearly between the two: a share in (0, 1] of the way
/// from the vertex. Safe in the haptic tick.
double interpolated_share(double vertex_density, double free_density, double isovalue);

/// a_i of (15): from `vertex_W`, in bone, towards `free_W`, outside it, as far as the surface, which is taken
/// where the density between them would cross the isovalue. Zero where the vertex is not in bone. Safe in the
/// haptic tick.
Vec3 interpolated_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W);

/// The same as far as the first bone that is met on the way from `free_W` to `vertex_W`, of which the first
/// `known_free_mm` are known to be free; the whole way where `free_W` is itself in bone. Safe in the haptic
/// tick.
Vec3 marched_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W, double known_free_mm = 0);

}  // namespace osteomill::surface_points
