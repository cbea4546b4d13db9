#pragma once

#include "osteomill/geometry/pose.h"
#include "osteomill/geometry/wrench.h"

namespace osteomill {

/// Where poses come from and wrenches go: a simulated operator, a virtual hand, a recorded trajectory; there
/// is none for hardware yet (docs/add-a-device.md). All calls come from the haptic thread, once a tick, and
/// none allocates, locks, logs or throws. But when the program crashes in real time and the haptic thread
/// does not answer, zero is written from the signal's handler.
class Device {
 public:
  virtual ~Device() = default;
  /// The handle's pose now, as a tool pose in W. Not finite where the device has none to give.
  virtual Pose read_pose() = 0;
  /// Sends a wrench that is already safe (finite, within the limits).
  virtual void write_wrench(const Wrench& wrench) = 0;

  /// Whether the operator asks for the spindle by a button or pedal of the device.
  virtual bool spindle_asked() const { return false; }
  /// The tick is over: where the simulated tool is shown, and how long it is until the next pose is read. A
  /// simulated device moves on; hardware has nothing to do.
  virtual void tick_done(const Pose& /*X_WT*/, double /*dt_s*/) {}
};

}  // namespace osteomill
