#pragma once

#include <optional>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// Bounds what a wrench may be, and how fast it may change, on its way to a hand. By default it protects a
/// person's hand; a session without one uses `for_simulation`.
struct GuardSettings {
  static constexpr double kAny = WrenchRates::kAny;

  WrenchLimits limits;
  WrenchRates rates = kHandWrenchRates;
  /// The time of a blend from the wrench sent before to the one asked for, when they need not agree.
  double blend_s = 0.1;
  /// The furthest that a device may move and turn in a tick, and the longest tick; beyond them the wrench
  /// falls to zero at `rates`.
  double max_move_mm = 5;
  double max_turn_rad = 0.2;
  double max_tick_s = 0.005;
  /// A damper is felt on contact while the hand has been given more energy than it gave (PassivityObserver).
  bool passivity_controller = false;

  /// Returns settings for a wrench that no person feels: it is shortened to `limits`, and otherwise is what
  /// the algorithm asks for, except for the controller if it is on. Not for a device that drives a hand: a
  /// single tick may bring all of 20 N.
  static GuardSettings for_simulation(const WrenchLimits& limits = {}, bool passivity_controller = false);
};

/// Throws std::invalid_argument, naming the setting, if a limit is not a positive number, or if a rate, a
/// time or a longest move is not a number or negative.
void require_workable(const GuardSettings& settings);

/// Counts how much energy a session has given to the hand, and has a damper that takes it back if it is more
/// than the hand gave: a passivity observer and controller in the time domain (Hannaford and Ryu, Time-domain
/// passivity control of haptic interfaces, IEEE Trans. Robotics and Automation 18(1), 2002). The wrench is
/// held between two poses, so its work is the sum of wrench times motion over the ticks, exactly, up to what
/// the device adds (delay, rounding). For one thread; all of it is safe in the haptic tick.
class PassivityObserver {
 public:
  /// Counts from zero, for a device that may be anywhere and is sent `sent`.
  void restart(const Wrench& sent) noexcept {
    energy_given_Nmm_ = 0;
    sent_ = sent;
    X_WD_.reset();
    moved_mm_.setZero();
    turned_rad_.setZero();
  }
  /// Counts the work of what was sent since the last reading of the device, now at `X_WD`. A pose that is not
  /// finite breaks the count off until the next that is.
  void move_to(const Pose& X_WD) noexcept;
  /// Sets the wrench that is sent from now on.
  void send(const Wrench& wrench) noexcept { sent_ = wrench; }

  /// Returns the energy given to the hand less what it gave, in N mm (mJ). A passive session never exceeds 0;
  /// one that is damped, no more than what the last tick of a contact gave.
  double energy_given_Nmm() const { return energy_given_Nmm_; }

  /// Returns a damping wrench that takes back what was given too much within a tick of `dt_s`, if the device
  /// goes on as in the last one; less if that were more damping than a device can show. Zero if the hand gave
  /// at least as much.
  Wrench damping(double dt_s) const noexcept;

 private:
  double energy_given_Nmm_ = 0;
  Wrench sent_;
  std::optional<Pose> X_WD_;
  // The device's motion in the last tick.
  Vec3 moved_mm_ = Vec3::Zero();
  Vec3 turned_rad_ = Vec3::Zero();
};

/// Stands between an algorithm and a hand: what is sent is within the limits, changes no faster than it may,
/// and comes up slowly if the hand may have sunk into bone unfelt (after a pause, with another algorithm or
/// bone, after a fault). A hand that begins to be driven, as at the start, is held back: it feels nothing
/// until the tool is out of bone, and then what it touches after that. It counts the energy that the hand is
/// given, and can keep it from being more than the hand gave. For one thread; all of it is safe in the haptic
/// tick.
class WrenchGuard {
 public:
  WrenchGuard() : WrenchGuard(GuardSettings{}) {}
  explicit WrenchGuard(const GuardSettings& settings) : settings_(settings) { hold_back(); }

  /// Returns the energy given to the hand less what it gave, in N mm, up to the last pose.
  double energy_given_Nmm() const { return observer_.energy_given_Nmm(); }
  /// Lets the wrench rise slowly from now on, from the one that was last sent.
  void restart() noexcept;
  /// Begins as restart does, in the place of another guard whose hand feels `sent` or was held back;
  /// energy is counted from now on.
  void begin_from(const Wrench& sent, bool held_back) noexcept;
  /// Sends zero from now on, because nothing that is sent reaches the hand, until the algorithm asks for next
  /// to nothing (kFreeForce_N, kFreeTorque_Nmm) in a tick in which the tool may be out of bone. Does nothing
  /// if no hand is protected (`blend_s` is 0).
  void hold_back() noexcept;
  bool is_held_back() const { return held_back_; }
  /// The force and the torque up to which an algorithm asks for next to nothing.
  static constexpr double kFreeForce_N = 0.5;
  static constexpr double kFreeTorque_Nmm = 12.5;
  /// Brings the wrench down to zero slowly, from now on, and keeps it there until `restart`.
  void fade_out() noexcept;
  const Wrench& sent() const { return sent_; }
  /// Returns whether zero was sent last.
  bool is_at_rest() const { return is_zero(sent_); }

  /// Returns what to send for a wrench in a tick of `dt_s`, with the reason if that is not what was asked
  /// for. Falls to zero at the settings' rates if the wrench is not finite, and lets the next ones come up
  /// slowly again. A tool that is in bone (`is_free` false) stays held back.
  SafeWrench filter(const Wrench& asked, const Pose& X_WD, double dt_s,
                    bool is_free = true) noexcept OSTEOMILL_NONBLOCKING;
  /// Returns what to send in a tick in which nothing may be felt, because of a pause or because there is no
  /// finite pose.
  SafeWrench filter_zero(const Pose& X_WD, double dt_s) noexcept OSTEOMILL_NONBLOCKING;

 private:
  SafeWrench send_zero(double dt_s) noexcept;
  SafeWrench approach(const Wrench& target, WrenchFault fault, double dt_s) noexcept;

  GuardSettings settings_;
  Wrench sent_;
  // The wrench from which a blend began, and how much of it is over.
  Wrench from_;
  double blended_ = 0;
  bool fading_out_ = false;
  bool held_back_ = false;
  std::optional<Pose> X_WD_;
  PassivityObserver observer_;
};

}  // namespace osteomill
