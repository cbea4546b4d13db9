#include "tool_move.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

// Upper bound on a tick's length, s, so that a stalled machine does not release the tool in one jump.
constexpr double kMaxTick_s = 5e-3;

}  // namespace

ToolMove move_between(const Pose& from, const Pose& to) noexcept {
  return {to.position_mm - from.position_mm,
          rotation_vector((to.orientation * from.orientation.conjugate()).normalized())};
}

Pose moved(const Pose& X_WT, const ToolMove& move) noexcept {
  const Quat turn = quaternion_from_rotation_vector(move.rotation_rad);
  return {X_WT.position_mm + move.translation_mm, (turn * X_WT.orientation).normalized()};
}

MoveBound move_bound(const Pose& X_WT, const Pose& X_WD_before, const Pose& X_WD, double spring_length_mm,
                     const Release& release, double dt_s) noexcept {
  const double tick_s = std::clamp(dt_s, 0.0, kMaxTick_s);
  const double fading = std::min(1.0, tick_s / release.time_s);
  const ToolMove device = move_between(X_WD_before, X_WD), stretch = move_between(X_WD_before, X_WT);
  const double moved_mm = device.translation_mm.norm(), turned_rad = device.rotation_rad.norm();
  // Enlargement of the balls on the side of increasing and of decreasing stretch.
  const double grow_mm = 0.5 * spring_length_mm * turned_rad,
               fade_mm = fading * stretch.translation_mm.norm();
  const double grow_rad = 0.5 * moved_mm / spring_length_mm, fade_rad = fading * stretch.rotation_rad.norm();
  return {{0.5 * (device.translation_mm + (grow_mm - fade_mm) * stretch.translation_mm.normalized()),
           0.5 * (device.rotation_rad + (grow_rad - fade_rad) * stretch.rotation_rad.normalized())},
          0.5 * (moved_mm + grow_mm + fade_mm) + release.mm_s * tick_s,
          0.5 * (turned_rad + grow_rad + fade_rad) + release.rad_s * tick_s};
}

double share_within(const Vec3& middle, double radius, const Vec3& from, const Vec3& change) noexcept {
  const Vec3 offset = from - middle;
  const double spare = radius * radius - offset.squaredNorm();
  if (spare < 0) return 0;
  if ((offset + change).norm() <= radius) return 1;
  const double along = offset.dot(change), length2 = change.squaredNorm();
  return std::min(1.0, (std::sqrt(along * along + length2 * spare) - along) / length2);
}

double share_within(const MoveBound& bound, const ToolMove& move) noexcept {
  return std::min(
      share_within(bound.middle.translation_mm, bound.radius_mm, Vec3::Zero(), move.translation_mm),
      share_within(bound.middle.rotation_rad, bound.radius_rad, Vec3::Zero(), move.rotation_rad));
}

Pose moved_within(const MoveBound& bound, const Pose& start, const Pose& target) noexcept {
  const ToolMove whole = move_between(start, target);
  const double share = share_within(bound, whole);
  return share >= 1 ? target : moved(start, share * whole);
}

}  // namespace osteomill
