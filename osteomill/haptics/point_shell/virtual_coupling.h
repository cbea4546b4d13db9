#pragma once

#include "osteomill/geometry/wrench.h"
#include "osteomill/haptics/point_shell/contact_sum.h"

namespace osteomill::point_shell {

/// A spring between the simulated tool and the device.
struct VirtualCoupling {
  double translational_N_per_mm;
  double torsional_Nmm_per_rad;
};

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
/// The move cut short so that neither part exceeds its limit; both by the same factor, so that a tool that
/// slides along the bone while it turns stays on it. A limit of 0 is none.
ToolMove limited(const ToolMove& move, double greatest_mm, double greatest_rad);

/// What share of the tool's move from `start` to `target` (0..1) brings it no more than `allowed_mm` and
/// `allowed_rad` nearer to the device; 1 where the whole move does not.
double share_released(const Pose& X_WT_start, const Pose& X_WT_target, const Pose& X_WD, double allowed_mm,
                      double allowed_rad);

/// The coupling's wrench as it acts on the hand that holds the device at `X_WD` (on the tool it is the
/// opposite).
Wrench wrench_on_hand(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD);

/// The move after which coupling and contacts balance, both linearised about `X_WT` (Eriksson 2012, eq. 22
/// and 23). `contacts` in W's axes at that pose. Safe in the haptic tick.
ToolMove balancing_move(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                        const ContactSum& contacts);

}  // namespace osteomill::point_shell
