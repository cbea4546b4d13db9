#pragma once

#include "osteomill/base/pose.h"

namespace osteomill {

/// A move of the simulated tool: the burr's centre by `translation_mm`, and about it by the rotation vector
/// `rotation_rad`, both in W's axes.
struct ToolMove {
  Vec3 translation_mm = Vec3::Zero();
  Vec3 rotation_rad = Vec3::Zero();
};

/// Returns a share of the move. Translation and rotation are shortened alike, so that a tool that slides
/// along the bone while it turns stays on it.
inline ToolMove operator*(double share, const ToolMove& move) {
  return {share * move.translation_mm, share * move.rotation_rad};
}

/// Returns the move that takes the tool from `from` to `to`.
ToolMove move_between(const Pose& from, const Pose& to) noexcept;
/// Returns the pose after the move.
Pose moved(const Pose& X_WT, const ToolMove& move) noexcept;

/// The move that a tick may add to the device's own: a share `tick / time_s` of the stretch between device
/// and tool, and a speed.
struct Release {
  double time_s = 0.1;
  double mm_s = 15;
  double rad_s = 0.05;
};

/// Bounds how far the simulated tool may go in a tick. The hand feels the stretch between tool and device,
/// and this bound keeps the stretch from leaping when bone gives way.
///
/// The tool's translation has to end in one ball and its rotation vector in another, both in W's axes. A tool
/// on a spring, held by frictionless surfaces, moves by some projection of the device's move. All projections
/// of a vector end on the sphere of which the vector is a diameter; the ball begins as that sphere. It is
/// widened all round by the release's speed, and on the side on which the stretch fades by the release's
/// share of the stretch. A turn of the device may also move a tool that is held at a lever, and a move may
/// turn it. So on the side on which the stretch grows, the ball of translations is widened by half the
/// device's turn times `spring_length_mm` (sqrt(torsional / translational stiffness)), and the ball of
/// rotations by half the device's move over that length. Standing still always lies within.
struct MoveBound {
  ToolMove middle;
  double radius_mm = 0;
  double radius_rad = 0;
};
MoveBound move_bound(const Pose& X_WT, const Pose& X_WD_before, const Pose& X_WD, double spring_length_mm,
                     const Release& release, double dt_s) noexcept;

/// The share (0..1) of a change that keeps `from` + share `change` in the ball about `middle`; 0 if `from`
/// is not in it.
double share_within(const Vec3& middle, double radius, const Vec3& from, const Vec3& change) noexcept;
/// The share of a move from the tick's start that stays within both balls.
double share_within(const MoveBound& bound, const ToolMove& move) noexcept;
/// Returns the pose on the way from the tick's start to the target, as far as the bound allows; the target
/// itself, to the last bit, if it lies within both balls.
Pose moved_within(const MoveBound& bound, const Pose& start, const Pose& target) noexcept;

}  // namespace osteomill
