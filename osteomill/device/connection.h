#pragma once

#include <string>

#include "osteomill/geometry/pose.h"
#include "osteomill/geometry/wrench.h"

namespace osteomill {

/// What a device can do, as it says itself or its maker does.
struct DeviceCapabilities {
  /// Maker, model and, where it has one, serial number: what a workspace is remembered by.
  std::string name;
  /// Degrees of freedom that it senses (3: position alone; 6) and drives (3: force alone; 6).
  int sensed = 6;
  int driven = 6;
  /// How the base D stands before the operator, placed as its maker means it to be: from D into the
  /// operator's view V (x to the right, y up, z towards the operator).
  Quat R_VD = Quat::Identity();
  /// The most that its motors give.
  WrenchLimits limits;
};

/// What a device said at one time, in its base frame D. An orientation that it does not sense is identity.
struct DeviceInput {
  Pose X_DH;
  /// A bit each; the first asks for the spindle.
  unsigned buttons = 0;
};

enum class ConnectionStatus : unsigned char {
  /// A new input has come.
  fresh,
  /// None has come within the time that was waited; the device may still be there.
  silent,
  /// The device is gone or refuses: it has to be opened again.
  lost,
};

/// A back end: the way to one opened device. Opened by a function of its own, which throws InputError naming
/// the device and why it cannot be had; destroying it sends zero and closes the device. All calls come from
/// one thread, which is not the haptic one: they may wait and make system calls, but no longer than said.
class Connection {
 public:
  virtual ~Connection() = default;
  virtual const DeviceCapabilities& capabilities() const = 0;
  /// Waits for the next input, 2 ms at most.
  virtual ConnectionStatus read(DeviceInput& input) = 0;
  /// Sends force and torque as they act on the hand, in D about the handle's origin; a device that drives
  /// force alone drops the torque. Finite, and within the capabilities' limits.
  virtual ConnectionStatus write(const Wrench& wrench_D) = 0;
};

}  // namespace osteomill
