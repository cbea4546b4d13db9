#pragma once

#include <string>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// Capabilities of a device, as reported by it or specified by its vendor (Connection::capabilities).
struct DeviceCapabilities {
  /// Vendor, model and, if available, serial number. The device's workspace is stored under this name.
  std::string name;
  /// Degrees of freedom sensed (3: position only; 6) and driven (3: force only; 6).
  int sensed = 6;
  int driven = 6;
  /// Rotation from the base frame B to the operator's view V (x right, y up, z towards the operator) if the
  /// device is placed as its vendor intends.
  Quat R_VB = Quat::Identity();
  /// Maximum force and torque of the motors.
  WrenchLimits limits;
  /// Time without a wrench after which the device's own watchdog switches to zero; 0 if unknown.
  double watchdog_s = 0;
};

/// One input from a device: the pose X_BH of its handle H in its base frame B (mm), its buttons and status.
/// The orientation is identity if it is not sensed.
struct DeviceInput {
  Pose X_BH;
  /// One bit per button; the first requests the spindle.
  unsigned buttons = 0;
  /// Reason why the device may not be driven now, and the remedy, as a phrase that follows "it" ("is not
  /// calibrated: ..."); null if it may be driven. While set, zero is sent.
  const char* not_driven = nullptr;
  /// Remark for the operator, in the same form; null if there is none.
  const char* remark = nullptr;
};

/// Result of a Connection call.
enum class ConnectionStatus : unsigned char {
  /// read: a new measurement, according to the device (a count, time stamp or status). write: the wrench was
  /// sent.
  fresh,
  /// read: no input within the timeout. write: the device cannot take the wrench yet. It may still be
  /// connected.
  silent,
  /// The device is disconnected or refuses; it must be reopened.
  lost,
};

/// A back end: the connection to one opened device. The function that opens it throws InputError with the
/// device's name and the reason; the destructor sends zero and closes the device. All calls come from one
/// thread, not the haptic one: they may allocate, make system calls and wait, within the limits stated below.
/// They report failures by their status and do not throw; a connection that throws is treated as lost.
class Connection {
 public:
  Connection() = default;
  virtual ~Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual const DeviceCapabilities& capabilities() const = 0;
  /// Waits up to 2 ms for the next input. A device at rest must report new inputs as well. Writes `input`
  /// only if the result is `fresh`.
  virtual ConnectionStatus read(DeviceInput& input) = 0;
  /// Sends the wrench on the hand, in B about the handle's origin; a device that drives only force ignores
  /// the torque. `wrench_B` is finite and within the capabilities' limits. Does not block: returns `silent`
  /// if the device cannot take it yet and keeps the previous wrench.
  virtual ConnectionStatus write(const Wrench& wrench_B) = 0;
};

}  // namespace osteomill
