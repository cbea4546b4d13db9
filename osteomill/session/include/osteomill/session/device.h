#pragma once

#include <algorithm>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// Returns the share, 0 to 1, of a force that was asked for that the force which was sent gives in its
/// direction. Safe in the haptic tick.
inline double sent_fraction(const Vec3& asked, const Vec3& sent) noexcept {
  // Zero for a vector that is too small to be squared, too.
  const double square = asked.squaredNorm();
  return sent == asked || square == 0 ? 1 : std::clamp(sent.dot(asked) / square, 0.0, 1.0);
}

/// The source of poses and the receiver of wrenches: hardware behind its thread (ConnectedDevice), a
/// simulated operator, a virtual hand, a recorded trajectory. All calls come from the haptic thread, once a
/// tick, and none allocates, locks or logs; only `disengage` and `engage` may come from anywhere. A device
/// that has failed for good may throw from `read_pose` and `write_wrench`: that ends the loop that runs it.
class Device {
 public:
  virtual ~Device() = default;
  /// Returns the handle's pose now, as a tool pose in W. Not finite if the device has none to give.
  virtual Pose read_pose() OSTEOMILL_NONBLOCKING = 0;
  /// Sends a wrench that is already safe (finite, within the limits).
  virtual void write_wrench(const Wrench& wrench) OSTEOMILL_NONBLOCKING = 0;
  /// Returns the share, 0 to 1, of the force that was written that has reached the hand (sent_fraction).
  /// Milling removes bone for that share alone.
  virtual double delivered_fraction() const noexcept OSTEOMILL_NONBLOCKING { return 1; }
  /// Returns whether what is written from now on reaches a hand; asked after `read_pose`. A device that was
  /// not driven since the last tick, however shortly, returns false once: its hand may have sunk into bone,
  /// and feels nothing until it is out (WrenchGuard::hold_back).
  virtual bool is_driven() const noexcept OSTEOMILL_NONBLOCKING { return true; }

  /// Returns whether the operator asks for the spindle by a button or pedal of the device.
  virtual bool is_spindle_requested() const noexcept OSTEOMILL_NONBLOCKING { return false; }
  /// Tells the device that the tick is over: the pose at which the simulated tool is shown, and the time
  /// until the next pose is read. Called once more before that if the next tick comes late. A simulated
  /// device moves on; hardware has nothing to do.
  virtual void tick_done(const Pose& /*X_WT*/, double /*dt_s*/) noexcept OSTEOMILL_NONBLOCKING {}
  /// Puts the tool at `X_WD`, wherever the hand is; from there it moves as the hand moves. Called between two
  /// ticks. A device that gives poses of its own (a trajectory) does nothing.
  virtual void put_at(const Pose& /*X_WD*/) noexcept OSTEOMILL_NONBLOCKING {}
  /// Sends zero from now on, whatever is written later, because the program is ending. Called from any
  /// thread, and from a signal's handler. Returns true once zero has gone out; it is called again until then.
  virtual bool disengage() noexcept {
    try {
      write_wrench(Wrench{});
      return true;
    } catch (...) {
      return false;
    }
  }
  /// Takes `disengage` back, because the program goes on after all (it was only stopped): what is written is
  /// sent again, and comes up slowly.
  virtual void engage() noexcept {}

 protected:
  Device() = default;
  // Not through the interface, which would copy a part.
  Device(const Device&) = default;
  Device& operator=(const Device&) = default;
};

}  // namespace osteomill
