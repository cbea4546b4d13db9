#pragma once

#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// A haptic device modelled as a rigid body with encoders and motors.
struct HandleSettings {
  double mass_kg = 0.3;
  /// About every axis through the burr's centre, where the centre of mass is assumed.
  double inertia_kg_m2 = 3e-4;
  /// Step of the encoder; 0 reads without rounding.
  double position_step_mm = 0.005;
  /// Angular step of the encoder: the step above at a lever arm of 50 mm. 0 reads without rounding.
  double rotation_step_rad = 1e-4;
  /// Delay from a command to its effect; rounded to whole substeps.
  double force_delay_s = 0.3e-3;
  /// Maximum force and torque of the motors.
  WrenchLimits limits;
  double substep_s = 50e-6;
};

/// Throws std::invalid_argument, naming the setting, if one is out of range.
void require_valid(const HandleSettings& settings);

/// The handle in simulated time. Translation and rotation are decoupled: the centre of mass is at the burr's
/// centre and the inertia is isotropic.
///
/// Integrated by semi-implicit Euler (velocity first, then position with the new velocity). For a spring k
/// and a damper b on a mass m it is stable while h^2 k/m + 2 h b/m < 4. Without a damper it conserves energy
/// on average, so energy growth in a measurement comes from the loop's delay, not from the integrator. At 20
/// kHz a wall of 40 N/mm on 0.3 kg has h^2 k/m = 3e-4, four orders of magnitude below the bound.
///
/// The constructor allocates; all other functions are safe in the haptic tick.
class SimulatedHandle {
 public:
  /// Starts at rest at `X_WD`. Throws std::invalid_argument as `require_valid` does.
  SimulatedHandle(const HandleSettings& settings, const Pose& X_WD);

  /// Places the handle at rest at `X_WD` and clears all commands.
  void reset(const Pose& X_WD) noexcept;

  /// Returns the current pose as read by the encoder: position rounded to whole steps in W, orientation to
  /// whole steps of the rotation vector from the initial orientation.
  Pose read() const noexcept;
  /// Commands a wrench on the handle, in W about the burr's centre. The motors apply it, clamped to their
  /// limits, after `force_delay_s`, until the next command takes effect.
  void command(const Wrench& wrench) noexcept;
  /// Advances by one substep. `other` is the wrench on the handle in addition to the motors': the hand's.
  void advance(const Wrench& other) noexcept;

  const HandleSettings& settings() const { return settings_; }
  /// Returns the true pose, not rounded by the encoder.
  const Pose& pose() const { return X_WD_; }
  /// Returns the true velocity.
  const Twist& velocity() const { return velocity_; }
  /// Returns the motors' wrench in the last substep.
  const Wrench& motor_wrench() const { return motor_wrench_; }
  /// Returns the kinetic energy in N mm (mJ).
  double kinetic_energy_Nmm() const;

 private:
  HandleSettings settings_;
  Pose X_WD_;
  Quat home_orientation_;
  Twist velocity_;
  Wrench commanded_;
  Wrench motor_wrench_;
  // Commands of the last substeps, the oldest at `oldest_`.
  std::vector<Wrench> delay_line_;
  std::size_t oldest_ = 0;
};

}  // namespace osteomill
