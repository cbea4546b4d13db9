#pragma once

#include "energy_sum.h"

namespace osteomill::barrier_shell {

/// Returns an upper bound on the part of a core's distance to a point that the whole move uses up; a share t
/// of the move uses at most t times that. The distance to a convex body is convex along a straight line, so
/// it falls no faster than at first; rotation bends the point's path in T by at most t^2 (|omega| |delta| +
/// 1/2 |omega|^2 |r|). Negative if the move leads away. Safe in the haptic tick.
inline double distance_used(const Vec3& point_T, const Vec3& outward_T, const Vector6& move_T) noexcept {
  const Vec3 delta_mm = move_T.head<3>(), omega_rad = move_T.tail<3>();
  const double omega = omega_rad.norm();
  return outward_T.dot(delta_mm + omega_rad.cross(point_T)) +
         omega * (delta_mm.norm() + 0.5 * omega * point_T.norm());
}

/// Returns the same bound for the ball, which rotation about its centre leaves unchanged: exact in
/// translation.
inline double distance_used_by_ball(const Vec3& outward_T, const Vector6& move_T) noexcept {
  return outward_T.dot(move_T.head<3>());
}

/// Smallest share of its distance that a step leaves to any point.
inline constexpr double kMinDistanceShare = 0.1;

/// Returns the largest share of a move that leaves every point `kMinDistanceShare` of its distance, given the
/// largest `distance_used / distance` of all points.
inline double certified_fraction(double max_use) noexcept {
  return max_use > 1 - kMinDistanceShare ? (1 - kMinDistanceShare) / max_use : 1.0;
}

}  // namespace osteomill::barrier_shell
