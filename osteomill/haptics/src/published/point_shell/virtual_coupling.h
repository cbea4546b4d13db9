#pragma once

#include "osteomill/base/wrench.h"

#include "published/point_shell/contacts.h"
#include "tool_move.h"

namespace osteomill::point_shell {

/// Spring and damper between the simulated tool and the device. Each damper is its spring's stiffness times
/// one time constant, given in ticks: the stretch is extrapolated by this time at its rate of change over the
/// last tick.
struct VirtualCoupling {
  double translational_N_per_mm;
  double torsional_Nmm_per_rad;
  double damping_ticks = 0;
};

/// Returns the coupling's wrench on the hand that holds the device at `X_WD`; the tool feels the opposite.
/// `stretch_before` is the move from the device to the tool at the end of the last tick.
Wrench wrench_on_hand(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                      const ToolMove& stretch_before) noexcept;

/// Returns the move that balances coupling and contacts, both linearised about `X_WT` (Eriksson 2012, eq. 22
/// and 23). `contacts` is in W's axes at that pose. Safe in the haptic tick.
ToolMove balancing_move(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                        const ToolMove& stretch_before, const EnergySum& contacts) noexcept;

}  // namespace osteomill::point_shell
