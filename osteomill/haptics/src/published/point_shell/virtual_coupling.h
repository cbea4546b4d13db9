#pragma once

#include "osteomill/base/wrench.h"

#include "published/point_shell/contacts.h"
#include "tool_move.h"

namespace osteomill::point_shell {

/// A spring and a damper between the simulated tool and the device. Each damper is its spring's stiffness
/// times one time, which is given in ticks: the stretch counts as if it continued for this time to change as
/// since the tick before.
struct VirtualCoupling {
  double translational_N_per_mm;
  double torsional_Nmm_per_rad;
  double damping_ticks = 0;
};

/// The coupling's wrench as it acts on the hand that holds the device at `X_WD` (on the tool it is the
/// opposite). `stretch_before` is the move from the device to the tool at the end of the tick before.
Wrench wrench_on_hand(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                      const ToolMove& stretch_before) noexcept;

/// The move after which coupling and contacts balance, both linearised about `X_WT` (Eriksson 2012, eq. 22
/// and 23). `contacts` in W's axes at that pose. Safe in the haptic tick.
ToolMove balancing_move(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                        const ToolMove& stretch_before, const EnergySum& contacts) noexcept;

}  // namespace osteomill::point_shell
