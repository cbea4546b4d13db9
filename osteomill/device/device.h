#pragma once

#include "osteomill/geometry/pose.h"
#include "osteomill/geometry/wrench.h"

namespace osteomill {

/// Where poses come from and wrenches go: a simulated operator, a mouse, a recorded trajectory, hardware.
/// Both calls come from the haptic thread, once a tick, and neither allocates, locks, logs or throws.
class Device {
 public:
  virtual ~Device() = default;
  /// The handle's pose now, as a tool pose in W. Not finite where the device has none to give.
  virtual Pose read_pose() = 0;
  /// Sends a wrench that is already safe (finite, within the limits).
  virtual void write_wrench(const Wrench& wrench) = 0;
};

}  // namespace osteomill
