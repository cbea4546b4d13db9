#pragma once

#include "osteomill/geometry/pose.h"

/// The numbered equations of algorithm 1 (Eriksson 2012, section 4), each a pure function. All points and
/// vectors are in W. Safe in the haptic tick; none of them guards against division by zero.
namespace osteomill::line_proxy {

/// Eq. 1: how far into its step from n-1 to n a vertex crosses the isosurface (0 to 1 where it was outside
/// before and is inside now; anything, also not finite, where it was inside already).
inline double crossing_fraction(double density_before, double density_at, double isovalue) {
  return (isovalue - density_before) / (density_at - density_before);
}

/// Eq. 2: the intersection point IP, from the most active vertex before and at the colliding step.
inline Vec3 intersection_point(const Vec3& before, const Vec3& at, double fraction) {
  return before + fraction * (at - before);
}

/// Eq. 3: the part of the translation `d` (mm) in one step of the walk.
inline Vec3 translation_step(const Vec3& translation, int steps) {
  return translation / steps;
}

/// Eq. 4: the part of the rotation `alpha` (a rotation vector, rad) in one step of the walk.
inline Vec3 rotation_step(const Vec3& rotation, int steps) {
  return rotation / steps;
}

/// Eq. 6: the force of the tip, k * e with e from the probe to the proxy. N.
inline Vec3 tip_force(double stiffness_N_per_mm, const Vec3& proxy, const Vec3& probe) {
  return stiffness_N_per_mm * (proxy - probe);
}

/// Eq. 7: r, from the tip's proxy to the intersection point.
inline Vec3 arm(const Vec3& intersection, const Vec3& proxy) {
  return intersection - proxy;
}

/// Eq. 8: the point as far up the device's shaft, laid at the tip's proxy, as IP is from the proxy.
inline Vec3 probe_intersection(const Vec3& arm, const Vec3& shaft_direction, const Vec3& proxy) {
  return arm.norm() * shaft_direction + proxy;
}

/// Eq. 9: g, the error of orientation alone.
inline Vec3 orientation_error(const Vec3& intersection, const Vec3& probe_intersection) {
  return intersection - probe_intersection;
}

/// Eq. 10: the reaction force at the intersection point. N.
inline Vec3 reaction_force(double stiffness_N_per_mm, const Vec3& orientation_error) {
  return stiffness_N_per_mm * orientation_error;
}

/// Eq. 11: the torque about the burr's centre. N mm.
inline Vec3 torque(const Vec3& arm, const Vec3& reaction_force) {
  return arm.cross(reaction_force);
}

/// Eq. 12: a point of the surface moved out by a radius along the outward unit normal u there.
inline Vec3 offset_point(const Vec3& surface_point, const Vec3& outward, double radius_mm) {
  return surface_point + outward * radius_mm;
}

/// Eq. 13: the vector along which the shaft is drawn.
inline Vec3 drawn_shaft(const Vec3& intersection_offset, const Vec3& proxy_offset) {
  return intersection_offset - proxy_offset;
}

}  // namespace osteomill::line_proxy
