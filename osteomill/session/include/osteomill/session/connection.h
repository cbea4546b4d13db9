#pragma once

#include <string>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// The abilities of a device, as it reports them or its maker states them (Connection::capabilities).
struct DeviceCapabilities {
  /// Maker, model and, if it has one, serial number. The device's workspace is kept under this name.
  std::string name;
  /// Degrees of freedom that it senses (3: position alone; 6) and drives (3: force alone; 6).
  int sensed = 6;
  int driven = 6;
  /// The rotation of the base B before the operator, if it is placed as its maker means it to be: from B into
  /// the operator's view V (x to the right, y up, z towards the operator).
  Quat R_VB = Quat::Identity();
  /// The most that its motors give.
  WrenchLimits limits;
  /// The time without a wrench after which the device's own watchdog sends zero; 0 if that is not known.
  double watchdog_s = 0;
};

/// One input of a device: the pose X_BH of its handle H in its base frame B (mm), and what else it reports.
/// An orientation that it does not sense is identity.
struct DeviceInput {
  Pose X_BH;
  /// A bit each; the first asks for the spindle.
  unsigned buttons = 0;
  /// Why no force may be sent to the device now, and what helps, to be read after "it" ("is not calibrated:
  /// ..."); null if force may be sent. Until then it is sent zero.
  const char* not_driven = nullptr;
  /// A remark on the device for the operator, in the same form; null if there is nothing.
  const char* remark = nullptr;
};

/// The result of a call of a Connection.
enum class ConnectionStatus : unsigned char {
  /// The input is one that the device has measured since the last, by its own word (a count, a time stamp, a
  /// status); the wrench has gone out.
  fresh,
  /// No input came within the time that was waited; the device may still be there.
  silent,
  /// The device is gone or refuses: it has to be opened again.
  lost,
};

/// A back end: the connection to one opened device. Each has a function that opens it, which throws
/// InputError naming the device and why it cannot be had; destroying it sends zero and closes the device. All
/// calls come from one thread, which is not the haptic one: they may allocate, make system calls and wait,
/// but no longer than said. They do not throw: the status reports a failure. (A connection that throws all
/// the same is taken for lost.)
class Connection {
 public:
  Connection() = default;
  virtual ~Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual const DeviceCapabilities& capabilities() const = 0;
  /// Waits for the next input, 2 ms at most. A device that stands still gives new inputs all the same.
  /// `input` is written to only if the result is `fresh`.
  virtual ConnectionStatus read(DeviceInput& input) = 0;
  /// Sends force and torque as they act on the hand, in B about the handle's origin; a device that drives
  /// force alone drops the torque. Finite, and within the capabilities' limits. Does not wait: returns
  /// `silent` if the device cannot take it yet and goes on with the wrench before.
  virtual ConnectionStatus write(const Wrench& wrench_B) = 0;
};

}  // namespace osteomill
