#pragma once

#include <cstddef>
#include <span>

#include "osteomill/milling/chip_law.h"

namespace osteomill {

/// The drive of the burr. `none` is an ideal drive that keeps its speed under any load.
enum class Handpiece { none, turbine, electric, surgical };

/// A drive whose torque falls linearly from `stall_Nmm` at rest to 0 at its free speed.
struct HandpieceType {
  const char* name;
  /// Default free speed.
  Sourced speed_rpm;
  Sourced stall_Nmm;
  /// Time constant of the run-up without load.
  Sourced run_up_s;
};

/// Returns the drives in the order of `Handpiece`.
std::span<const HandpieceType> handpiece_types();

/// The speed of a spindle under load: `J dw/dt = T_stall (1 - w / w0) - T`, integrated implicitly. Not
/// thread-safe.
class Spindle {
 public:
  /// `set_rpm` is the free speed, above 0.
  Spindle(Handpiece handpiece, double set_rpm) : type_(handpiece), set_rpm_(set_rpm) {}

  double speed_rpm() const { return speed_rpm_; }
  double set_rpm() const { return set_rpm_; }
  /// Returns the stall torque; infinite for `Handpiece::none`.
  double stall_Nmm() const { return handpiece_types()[static_cast<std::size_t>(type_)].stall_Nmm.value; }
  void begin_from(double speed_rpm) { speed_rpm_ = speed_rpm; }

  /// Advances by `dt_s` against the load torque `torque_Nmm` (not negative). Without the drive (`is_on`) the
  /// spindle coasts down, and with `Handpiece::none` stops at once. The speed never falls below 0.
  /// Safe in the haptic tick.
  void step(bool is_on, double torque_Nmm, double dt_s) noexcept;

 private:
  Handpiece type_;
  double set_rpm_;
  double speed_rpm_ = 0;
};

}  // namespace osteomill
