#pragma once

#include <optional>

#include "osteomill/geometry/wrench.h"
#include "osteomill/session/passivity_observer.h"

namespace osteomill {

/// What a wrench may be, and how fast it may change, on its way to a hand.
struct GuardSettings {
  static constexpr double kAny = WrenchRates::kAny;

  WrenchLimits limits;
  WrenchRates rates;
  /// How long it takes from what was sent before to what is asked for, where they need not agree.
  double blend_s = 0;
  /// The furthest that a device moves and turns in a tick, and the longest tick; beyond them zero is sent.
  double max_move_mm = kAny;
  double max_turn_rad = kAny;
  double max_tick_s = kAny;
  /// A damper is felt on contact while the hand has been given more energy than it gave (PassivityObserver).
  bool passivity_controller = false;

  /// The same for a person's hand: kRatesForAHand, a blend of 0.1 s, moves of up to 5 mm and 0.2 rad
  /// and ticks of up to 5 ms. The default only shortens to the limits, for hands that are simulated.
  GuardSettings for_a_hand() const;
};

/// Stands between an algorithm and a hand: what is sent is within the limits, changes no faster than it may,
/// and comes up slowly where the hand may have sunk into bone unfelt (at the start, after a pause, with
/// another algorithm or bone, after a fault). It counts the energy that the hand is given, and can keep it
/// from being more than the hand gave. One thread's; all of it is safe in the haptic tick.
class WrenchGuard {
 public:
  WrenchGuard() : WrenchGuard(GuardSettings{}) {}
  explicit WrenchGuard(const GuardSettings& settings) : settings_(settings) {}

  /// From now on for a person's hand (GuardSettings::for_a_hand).
  void protect_a_hand() { settings_ = settings_.for_a_hand(); }
  /// Given to the hand less what it gave, in N mm, up to the last pose.
  double energy_given_Nmm() const { return observer_.energy_given_Nmm(); }
  /// From now what is asked for comes up slowly, from what was last sent.
  void begin_anew();
  /// The same where the hand feels `sent`, from whatever stood here before; energy is counted from here.
  void begin_from(const Wrench& sent);
  /// From now zero is sent, come down to slowly, until `begin_anew`.
  void let_go();
  const Wrench& sent() const { return sent_; }
  /// Zero was sent last.
  bool is_at_rest() const;
  const GuardSettings& settings() const { return settings_; }

  /// What to send for a wrench in a tick of `dt_s`, with the reason where that is not what was asked for. One
  /// that is not finite is zero, and what follows begins anew.
  SafeWrench pass(const Wrench& asked, const Pose& X_WD, double dt_s);
  /// The same where nothing is felt: no pose that is finite, or a pause.
  SafeWrench pass_zero(const Pose& X_WD, double dt_s);

 private:
  SafeWrench send_zero(double dt_s);
  SafeWrench approach(const Wrench& target, WrenchFault fault, double dt_s);

  GuardSettings settings_;
  Wrench sent_;
  // The wrench from which a blend began, and how much of it is over.
  Wrench from_;
  double blended_ = 0;
  bool let_go_ = false;
  std::optional<Pose> X_WD_;
  PassivityObserver observer_;
};

}  // namespace osteomill
