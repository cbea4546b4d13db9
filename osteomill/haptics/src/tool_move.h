#pragma once

#include "osteomill/base/pose.h"

namespace osteomill {

/// A motion of the simulated tool: translation of the burr's centre and rotation vector about it, both in W's
/// axes.
struct ToolMove {
  Vec3 translation_mm = Vec3::Zero();
  Vec3 rotation_rad = Vec3::Zero();
};

/// Returns a share of the move. Scales translation and rotation alike, so that a tool sliding along the bone
/// while it rotates stays on it.
inline ToolMove operator*(double share, const ToolMove& move) {
  return {share * move.translation_mm, share * move.rotation_rad};
}

/// Returns the move from pose `from` to pose `to`.
ToolMove move_between(const Pose& from, const Pose& to) noexcept;
/// Returns the pose after the move.
Pose moved(const Pose& X_WT, const ToolMove& move) noexcept;

/// The motion that a tick may add to the device's own: a share `tick / time_s` of the stretch between device
/// and tool, plus a speed.
struct Release {
  double time_s = 0.1;
  double mm_s = 15;
  double rad_s = 0.05;
};

/// Bound on the simulated tool's motion in one tick. The hand feels the stretch between tool and device, and
/// this bound keeps the stretch from jumping when bone gives way.
///
/// The tool's translation must end in one ball and its rotation vector in another, both in W's axes. A tool
/// on a spring, held by frictionless surfaces, moves by a projection of the device's move. All projections of
/// a vector end on the sphere that has the vector as its diameter; the ball starts as that sphere. It is
/// enlarged all round by the release speed, and on the side of decreasing stretch by the release's share of
/// the stretch. Rotating the device may also translate a tool held at a lever arm, and translating it may
/// rotate the tool. So on the side of increasing stretch the translation ball is enlarged by half the
/// device's rotation times `spring_length_mm` (sqrt(torsional / translational stiffness)), and the rotation
/// ball by half the device's translation divided by that length. Standing still is always within the bound.
struct MoveBound {
  ToolMove middle;
  double radius_mm = 0;
  double radius_rad = 0;
};
MoveBound move_bound(const Pose& X_WT, const Pose& X_WD_before, const Pose& X_WD, double spring_length_mm,
                     const Release& release, double dt_s) noexcept;

/// Returns the share (0 to 1) of `change` that keeps `from` + share * `change` in the ball; 0 if `from` is
/// outside it.
double share_within(const Vec3& middle, double radius, const Vec3& from, const Vec3& change) noexcept;
/// Returns the share of a move from the tick's start that stays within both balls.
double share_within(const MoveBound& bound, const ToolMove& move) noexcept;
/// Returns the pose reached from `start` towards `target` as far as the bound allows; exactly `target` if it
/// is within both balls.
Pose moved_within(const MoveBound& bound, const Pose& start, const Pose& target) noexcept;

}  // namespace osteomill
