#pragma once

#include <optional>

#include "osteomill/geometry/wrench.h"

namespace osteomill {

/// How much energy a session has given to the hand, and a damper that takes it back where it is more than the
/// hand gave: a passivity observer and controller in the time domain (Hannaford and Ryu, Time-domain
/// passivity control of haptic interfaces, IEEE Trans. Robotics and Automation 18(1), 2002). The wrench is
/// held between two poses, so its work is the sum of wrench times motion over the ticks, exactly, up to what
/// the device adds (delay, rounding). One thread's; all of it is safe in the haptic tick.
class PassivityObserver {
 public:
  /// Counts from zero, for a device that may be anywhere and is sent `sent`.
  void begin_anew(const Wrench& sent) {
    energy_given_Nmm_ = 0;
    sent_ = sent;
    X_WD_.reset();
    moved_mm_.setZero();
    turned_rad_.setZero();
  }
  /// The device was read at `X_WD`: counts the work of what was sent since the last reading. One that is not
  /// finite breaks the count off until the next that is.
  void move_to(const Pose& X_WD);
  /// What is sent from now on.
  void send(const Wrench& wrench) { sent_ = wrench; }

  /// Given to the hand less what it gave, in N mm (mJ). A passive session never exceeds 0; one that is
  /// damped, no more than what the last tick of a contact gave.
  double energy_given_Nmm() const { return energy_given_Nmm_; }

  /// A damping wrench that takes back what was given too much within a tick of `dt_s`, if the device goes on
  /// as in the last one; less where that were more damping than a device can show. Zero where nothing is
  /// owed.
  Wrench damping(double dt_s) const;

 private:
  double energy_given_Nmm_ = 0;
  Wrench sent_;
  std::optional<Pose> X_WD_;
  // The device's motion in the last tick.
  Vec3 moved_mm_ = Vec3::Zero();
  Vec3 turned_rad_ = Vec3::Zero();
};

}  // namespace osteomill
