#pragma once

#include "osteomill/volume/volume.h"

/// The springs of the vertices, and what is near them. Safe in the haptic tick.
namespace osteomill::surface_points {

/// a_i of (15): from `vertex_W`, in bone, towards `free_W`, outside it, as far as the surface, which is taken
/// where the density between them would cross the isovalue. Zero where the vertex is not in bone. Safe in the
/// haptic tick.
Vec3 interpolated_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W);

/// The spring as far as the first bone that is met on the way from `free_W` to `vertex_W`, to 0.0001 mm; the
/// whole way where `free_W` is itself in bone. The first `known_free_mm` are taken to be free unless their
/// end is in bone. Looks every half voxel, but no closer than every 0.045 mm: what is thinner than that does
/// not hold a tool, and in the finest scans most of the looks would be for it. A third of the samples of
/// `first_crossing`. Safe in the haptic tick.
Vec3 marched_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W, double known_free_mm = 0);

/// False only where no point of the disc (its axis a unit vector in W; zero makes it a ball) is in bone; by
/// brick, so it errs by up to a brick. Costs less than two density samples. Safe in the haptic tick.
bool bone_near_disc(const Volume& volume, const Vec3& centre_W, const Vec3& axis_W, double radius_mm);

}  // namespace osteomill::surface_points
