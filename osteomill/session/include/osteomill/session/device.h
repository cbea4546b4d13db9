#pragma once

#include <algorithm>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// Returns the component of `sent` along `asked` as a fraction of `asked`, clamped to [0, 1]; 1 if `asked` is
/// zero. Safe in the haptic tick.
inline double sent_fraction(const Vec3& asked, const Vec3& sent) noexcept {
  // Also 0 if the square of a tiny vector underflows.
  const double square = asked.squaredNorm();
  return sent == asked || square == 0 ? 1 : std::clamp(sent.dot(asked) / square, 0.0, 1.0);
}

/// Source of poses and sink of wrenches: hardware behind its own thread (ConnectedDevice), a simulated
/// operator, a virtual hand, a recorded trajectory. The haptic thread calls each function once per tick; only
/// `disengage` and `engage` may be called from any thread. Implementations must not allocate, lock or log. A
/// device that has failed permanently may throw from `read_pose` and `write_wrench`, which ends the loop that
/// runs it.
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
  /// Returns whether wrenches written from now on reach the hand. Called after `read_pose`. If the device was
  /// not driven at any time since the last tick, returns false once: the hand may have sunk into bone, so the
  /// session sends zero until the tool is out (WrenchGuard::hold_back).
  virtual bool is_driven() const noexcept OSTEOMILL_NONBLOCKING { return true; }

  /// Returns whether a button or pedal of the device requests the spindle.
  virtual bool is_spindle_requested() const noexcept OSTEOMILL_NONBLOCKING { return false; }
  /// Ends the tick. `X_WT` is the pose of the simulated tool, `dt_s` the time until the next pose is read.
  /// Called once more before that if the next tick is late. A simulated device advances its simulation;
  /// hardware does nothing.
  virtual void tick_done(const Pose& /*X_WT*/, double /*dt_s*/) noexcept OSTEOMILL_NONBLOCKING {}
  /// Places the tool at `X_WD`, wherever the hand is; from there it follows the hand's motion. Called between
  /// two ticks. A device with predetermined poses (a trajectory) ignores it.
  virtual void put_at(const Pose& /*X_WD*/) noexcept OSTEOMILL_NONBLOCKING {}
  /// Sends zero from now on, whatever is written later, because the program is ending. Callable from any
  /// thread and from a signal handler. Returns true once zero has been sent; the caller repeats the call
  /// until then.
  virtual bool disengage() noexcept {
    try {
      write_wrench(Wrench{});
      return true;
    } catch (...) {
      return false;
    }
  }
  /// Reverts `disengage` when the program continues (it was only stopped): wrenches are sent again, rising
  /// slowly.
  virtual void engage() noexcept {}

 protected:
  Device() = default;
  // Protected, because copying through the interface would slice.
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;
};

}  // namespace osteomill
