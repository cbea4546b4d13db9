#pragma once

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// How the simulated tool moves: the burr's centre by `translation_mm`, and about it by the rotation vector
/// `rotation_rad`, both in W's axes.
struct ToolMove {
  Vec3 translation_mm = Vec3::Zero();
  Vec3 rotation_rad = Vec3::Zero();
};

/// The move that takes the tool from `from` to `to`.
ToolMove move_between(const Pose& from, const Pose& to);
/// The pose after the move.
Pose moved(const Pose& X_WT, const ToolMove& move);

/// Short of the target where a tool that was held back would come nearer to the device faster than it may, so
/// that what is felt fades where bone gives way: at 15 mm/s and 0.05 rad/s, beside the device's own motion
/// and a stretch that falls to a third in 0.1 s. Being pushed away is not held up. `length_mm` from the
/// burr's centre to the tool's far end. The target itself, to the last bit, where it may be reached.
Pose released(const Pose& X_WT_start, const Pose& X_WT_target, const Pose& X_WD_before, const Pose& X_WD,
              double length_mm, double dt_s);

/// What share of the tool's move from `start` to `target` (0..1) brings it no more than `allowed_mm` and
/// `allowed_rad` nearer to the device; 1 where the whole move does not.
double share_released(const Pose& X_WT_start, const Pose& X_WT_target, const Pose& X_WD, double allowed_mm,
                      double allowed_rad);

}  // namespace osteomill
