#pragma once

#include <algorithm>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// Returns the share of the requested vector `asked` that `sent` contains: its projection on `asked`, 0 to 1;
/// 1 if `asked` is zero. Safe in the haptic tick.
inline double sent_fraction(const Vec3& asked, const Vec3& sent) noexcept {
  // Also 0 if the square of a tiny vector underflows.
  const double square = asked.squaredNorm();
  return sent == asked || square == 0 ? 1 : std::clamp(sent.dot(asked) / square, 0.0, 1.0);
}

/// Source of poses and sink of wrenches: hardware behind its own thread (ConnectedDevice), a simulated
/// operator, a virtual hand, a recorded trajectory. The haptic thread makes all calls, `put_at` between
/// two ticks; only `disengage` and `engage` may come from any thread. Implementations must not allocate, lock
/// or log. A device that has failed permanently may throw from `read_pose` and `write_wrench`, which ends the
/// loop that runs it.
class Device {
 public:
  virtual ~Device() = default;
  /// Returns the current pose of the handle as a tool pose in W. Not finite if the device has no pose.
  virtual Pose read_pose() OSTEOMILL_NONBLOCKING = 0;
  /// Sends a wrench that is already safe (finite, within the limits).
  virtual void write_wrench(const Wrench& wrench) OSTEOMILL_NONBLOCKING = 0;
  /// Returns the fraction, 0 to 1, of the written force that has reached the hand (sent_fraction). Only that
  /// fraction removes bone.
  virtual double delivered_fraction() const noexcept OSTEOMILL_NONBLOCKING { return 1; }
  /// Returns whether wrenches written from now on reach the hand. Called after `read_pose`. Returns false at
  /// least once if driving was interrupted since the last tick: the hand may have sunk into bone, so the
  /// session sends zero until the tool is out (WrenchGuard::hold_back).
  virtual bool is_driven() const noexcept OSTEOMILL_NONBLOCKING { return true; }

  /// Returns whether a button or pedal of the device requests the spindle.
  virtual bool is_spindle_requested() const noexcept OSTEOMILL_NONBLOCKING { return false; }
  /// Ends the tick. `X_WT` is the pose of the simulated tool, `dt_s` the time until the next pose is read.
  /// After missed ticks it is called a second time, with the extra time. A simulated device advances its
  /// simulation; hardware does nothing.
  virtual void tick_done(const Pose& /*X_WT*/, double /*dt_s*/) noexcept OSTEOMILL_NONBLOCKING {}
  /// Places the tool at `X_WD`, wherever the hand is; from there it follows the hand's motion. Called between
  /// two ticks. A device with predetermined poses (a trajectory) ignores it.
  virtual void put_at(const Pose& /*X_WD*/) noexcept OSTEOMILL_NONBLOCKING {}
  /// Called when the program ends or is stopped, from any thread or a signal handler, also while another
  /// thread is in `write_wrench`. Sends zero and ignores wrenches written later, until `engage`. Returns true
  /// once zero has been sent; the caller repeats the call until then. The default only writes a wrench of
  /// zero: override it if `write_wrench` is not signal-safe, or if the loop goes on to write.
  virtual bool disengage() noexcept {
    try {
      write_wrench(Wrench{});
      return true;
    } catch (...) {
      return false;
    }
  }
  /// Reverts `disengage` when a stopped program continues: wrenches are sent again, rising slowly. The
  /// default does nothing, as fits the default of `disengage`.
  virtual void engage() noexcept {}

 protected:
  Device() = default;
  // Protected, because copying through the interface would slice.
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;
};

}  // namespace osteomill
