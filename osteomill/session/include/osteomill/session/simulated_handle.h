#pragma once

#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// A haptic device as a rigid body that is read through an encoder and pushed by its motors.
struct HandleSettings {
  double mass_kg = 0.3;
  /// About every axis through the burr's centre, where the centre of mass is taken to be.
  double inertia_kg_m2 = 3e-4;
  /// The encoder's step; 0 reads without rounding.
  double position_step_mm = 0.005;
  /// The encoder's step of rotation: the step above at the end of a lever of 50 mm. 0 reads without rounding.
  double rotation_step_rad = 1e-4;
  /// The time from a command until the motors act on it; rounded to whole substeps.
  double force_delay_s = 0.3e-3;
  /// The most that the motors can give.
  WrenchLimits limits;
  double substep_s = 50e-6;
};

/// Throws std::invalid_argument, naming the setting, if one is out of range.
void require_valid(const HandleSettings& settings);

/// The handle in simulated time. Position and rotation do not couple: the centre of mass lies at the burr's
/// centre and the inertia is the same about every axis.
///
/// Integrated by semi-implicit Euler (first the velocity, then the position with the new velocity). For a
/// spring k and a damper b on a mass m it is stable while h^2 k/m + 2 h b/m < 4, and without a damper it
/// neither loses nor gains energy on the average, so that what grows in a measurement grows by the loop's
/// delay and not by the integrator. At 20 kHz a wall of 40 N/mm on 0.3 kg has h^2 k/m = 3e-4: four orders of
/// magnitude inside.
///
/// Made outside the tick (it allocates); everything else is safe in it.
class SimulatedHandle {
 public:
  /// Makes a handle at rest at `X_WD`. Throws std::invalid_argument as `require_valid` does.
  SimulatedHandle(const HandleSettings& settings, const Pose& X_WD);

  /// Puts the handle at `X_WD`, at rest, with nothing commanded.
  void reset(const Pose& X_WD) noexcept;

  /// Returns the pose as the encoder reads it now: position to whole steps in W, orientation to whole steps
  /// of the rotation vector from the handle's orientation at the start.
  Pose read() const noexcept;
  /// Commands a wrench (on the handle, in W, about the burr's centre). The motors give it, within their
  /// limits, from `force_delay_s` later on, until the next command takes effect.
  void command(const Wrench& wrench) noexcept;
  /// Moves the handle on by one substep. `other` is the wrench that acts on it beside the motors: the hand's.
  void advance(const Wrench& other) noexcept;

  const HandleSettings& settings() const { return settings_; }
  /// Returns the true pose, without the encoder's steps.
  const Pose& pose() const { return X_WD_; }
  /// Returns the true velocity.
  const Twist& velocity() const { return velocity_; }
  /// Returns the wrench that the motors gave in the last substep.
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
