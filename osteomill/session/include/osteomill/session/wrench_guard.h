#pragma once

#include <optional>

#include "osteomill/base/nonblocking.h"
#include "osteomill/base/wrench.h"

namespace osteomill {

/// Limits of a wrench and of its rate of change on the way to a hand. The defaults protect a human hand; a
/// session without one uses `for_simulation`.
struct GuardSettings {
  static constexpr double kAny = WrenchRates::kAny;

  WrenchLimits limits;
  WrenchRates rates = kHandWrenchRates;
  /// Duration of the blend from the last sent wrench to the requested one after a discontinuity.
  double blend_s = 0.1;
  /// Maximum displacement and rotation of the device per tick, and maximum tick length; beyond them the
  /// wrench falls to zero at `rates`.
  double max_move_mm = 5;
  double max_turn_rad = 0.2;
  double max_tick_s = 0.005;
  /// Adds damping during contact while the hand has been given net energy (PassivityObserver).
  bool passivity_controller = false;

  /// Returns settings for a wrench that no person feels: only clamps it to `limits` and applies the passivity
  /// controller if that is on. Not for a device that drives a hand: the force may jump to 20 N in a single
  /// tick.
  static GuardSettings for_simulation(const WrenchLimits& limits = {}, bool passivity_controller = false);
};

/// Throws std::invalid_argument, naming the setting, if a limit is not positive and finite, `blend_s` is
/// negative or not finite, or a rate, maximum move or maximum tick length is not above 0 (infinity is
/// allowed).
void require_workable(const GuardSettings& settings);

/// Time-domain passivity observer and controller (Hannaford and Ryu, Time-domain passivity control of haptic
/// interfaces, IEEE Trans. Robotics and Automation 18(1), 2002): sums the net energy given to the hand and
/// provides damping that takes back any excess. The wrench is constant between two poses, so its work is
/// exactly the sum of wrench times motion, except for the device's own delay and rounding. For one thread;
/// safe in the haptic tick.
class PassivityObserver {
 public:
  /// Resets the energy to zero. The device's pose is unknown; it currently receives `sent`.
  void restart(const Wrench& sent) noexcept {
    energy_given_Nmm_ = 0;
    sent_ = sent;
    X_WD_.reset();
    moved_mm_.setZero();
    turned_rad_.setZero();
  }
  /// Adds the work of the sent wrench from the last pose to `X_WD`. After a pose that is not finite,
  /// summation resumes at the next finite one.
  void move_to(const Pose& X_WD) noexcept;
  /// Sets the wrench currently sent.
  void send(const Wrench& wrench) noexcept { sent_ = wrench; }

  /// Returns the net energy given to the hand, N mm (mJ). Never above 0 for a passive session; with the
  /// controller, at most the energy given in the last tick of a contact.
  double energy_given_Nmm() const { return energy_given_Nmm_; }

  /// Returns the damping wrench that takes back the excess energy within one tick of `dt_s` if the device
  /// keeps its last velocity; limited to the damping that a device can render stably. Zero without excess
  /// energy.
  Wrench damping(double dt_s) const noexcept;

 private:
  double energy_given_Nmm_ = 0;
  Wrench sent_;
  std::optional<Pose> X_WD_;
  // Motion of the device in the last tick.
  Vec3 moved_mm_ = Vec3::Zero();
  Vec3 turned_rad_ = Vec3::Zero();
};

/// Filters wrenches between an algorithm and a hand: clamps them, limits their rate of change, and lets them
/// rise slowly if the hand may have sunk into bone unnoticed (after a pause, a change of algorithm or bone,
/// or a fault). When a hand begins to be driven, as at the start, it is held back: zero is sent until the
/// tool is out of bone. Also sums the energy given to the hand and can keep it passive. For one thread; safe
/// in the haptic tick.
class WrenchGuard {
 public:
  WrenchGuard() : WrenchGuard(GuardSettings{}) {}
  explicit WrenchGuard(const GuardSettings& settings) : settings_(settings) { hold_back(); }

  /// Returns the net energy given to the hand up to the last pose, N mm.
  double energy_given_Nmm() const { return observer_.energy_given_Nmm(); }
  /// Starts a blend from the last sent wrench.
  void restart() noexcept;
  /// Takes over from another guard, whose hand feels `sent` or was held back: blends from `sent` and counts
  /// energy from zero.
  void begin_from(const Wrench& sent, bool held_back) noexcept;
  /// Call while the device is not driven. Sends zero from now on until, in a tick in which the tool may be
  /// out of bone, the requested wrench is below kFreeForce_N and kFreeTorque_Nmm. Does nothing if no hand is
  /// protected (`blend_s` is 0).
  void hold_back() noexcept;
  bool is_held_back() const { return held_back_; }
  /// Largest requested force and torque that still count as free space.
  static constexpr double kFreeForce_N = 0.5;
  static constexpr double kFreeTorque_Nmm = 12.5;
  /// Fades the wrench to zero and keeps it there until `restart`.
  void fade_out() noexcept;
  const Wrench& sent() const { return sent_; }
  /// Returns whether the last sent wrench is zero.
  bool is_at_rest() const { return is_zero(sent_); }

  /// Returns the wrench to send for the requested one in a tick of `dt_s`, with the reason if they differ. If
  /// `asked` is not finite, falls to zero at the settings' rates and then blends in the following ones. A
  /// hand whose tool is in bone (`is_free` false) stays held back.
  SafeWrench filter(const Wrench& asked, const Pose& X_WD, double dt_s,
                    bool is_free = true) noexcept OSTEOMILL_NONBLOCKING;
  /// Returns the wrench to send in a tick that must render zero, because of a pause or a pose that is not
  /// finite.
  SafeWrench filter_zero(const Pose& X_WD, double dt_s) noexcept OSTEOMILL_NONBLOCKING;

 private:
  SafeWrench send_zero(double dt_s) noexcept;
  SafeWrench approach(const Wrench& target, WrenchFault fault, double dt_s) noexcept;

  GuardSettings settings_;
  Wrench sent_;
  // Wrench from which the blend started, and its progress, 0 to 1.
  Wrench from_;
  double blended_ = 0;
  bool fading_out_ = false;
  bool held_back_ = false;
  std::optional<Pose> X_WD_;
  PassivityObserver observer_;
};

}  // namespace osteomill
