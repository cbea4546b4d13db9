#pragma once

#include <cmath>

#include "osteomill/base/wrench.h"

#include "energy_sum.h"

namespace osteomill::barrier_shell {

/// A spring between the simulated tool and the device, with a potential: quadratic up to the largest force
/// and torque, linear beyond (Huber), so that the wrench never exceeds them. Safe in the haptic tick.
struct Coupling {
  double translational_N_per_mm;
  double torsional_Nmm_per_rad;
  double max_force_N = WrenchLimits{}.force_N;
  double max_torque_Nmm = WrenchLimits{}.torque_Nmm;

  /// Returns the wrench on the hand that holds the device at `X_WD`, in W.
  Wrench wrench_on_hand(const Pose& X_WT, const Pose& X_WD) const noexcept;
  /// Returns the lever arm at which a force stores equal energy in both springs.
  double length_mm() const noexcept { return std::sqrt(torsional_Nmm_per_rad / translational_N_per_mm); }
  double energy_Nmm(const Pose& X_WT, const Pose& X_WD) const noexcept;
  /// Returns the energy and its derivatives with respect to tool motion; `convex` is the whole second
  /// derivative.
  EnergySum sum(const Pose& X_WT, const Pose& X_WD) const noexcept;
};

}  // namespace osteomill::barrier_shell
