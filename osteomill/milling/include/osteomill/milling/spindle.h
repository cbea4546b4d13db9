#pragma once

#include <cstddef>
#include <span>

#include "osteomill/milling/chip_law.h"

namespace osteomill {

/// The drive of the burr. `none` keeps its speed whatever the load.
enum class Handpiece { none, turbine, electric, surgical };

/// A drive whose torque falls in a straight line from `stall_Nmm` at rest to nothing at its free speed.
struct HandpieceType {
  const char* name;
  /// The free speed unless another is set.
  Sourced speed_rpm;
  Sourced stall_Nmm;
  /// The time in which an unloaded drive comes within 1/e of its free speed.
  Sourced run_up_s;
};

/// Returns the drives in the order of `Handpiece`.
std::span<const HandpieceType> handpiece_types();

/// The speed of a spindle under load: `J dw/dt = T_stall (1 - w / w0) - T`, solved implicitly. For one
/// thread.
class Spindle {
 public:
  /// The free speed `set_rpm` is above 0.
  Spindle(Handpiece handpiece, double set_rpm) : type_(handpiece), set_rpm_(set_rpm) {}

  double speed_rpm() const { return speed_rpm_; }
  double set_rpm() const { return set_rpm_; }
  /// The most torque that the drive has; infinite without a handpiece.
  double stall_Nmm() const { return handpiece_types()[static_cast<std::size_t>(type_)].stall_Nmm.value; }
  void begin_from(double speed_rpm) { speed_rpm_ = speed_rpm; }

  /// Goes on by a tick in which the drive is on or off and the load holds it back by `torque_Nmm`, not
  /// negative. The speed never goes below 0: a stalled burr stands. Safe in the haptic tick.
  void step(bool is_on, double torque_Nmm, double dt_s) noexcept;

 private:
  Handpiece type_;
  double set_rpm_;
  double speed_rpm_ = 0;
};

}  // namespace osteomill
