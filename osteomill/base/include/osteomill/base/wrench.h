#pragma once

#include <limits>
#include <string_view>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Force and torque on the hand: in the axes of the world frame W, the torque about the burr's centre, unless
/// a name states otherwise (`wrench_B`: in the device's base frame, about the origin of its handle).
struct Wrench {
  Vec3 force_N = Vec3::Zero();
  Vec3 torque_Nmm = Vec3::Zero();

  friend Wrench operator+(const Wrench& a, const Wrench& b) {
    return {a.force_N + b.force_N, a.torque_Nmm + b.torque_Nmm};
  }
  friend Wrench operator*(double share, const Wrench& wrench) {
    return {share * wrench.force_N, share * wrench.torque_Nmm};
  }
};

/// The largest force and torque that may be sent to a device.
struct WrenchLimits {
  double force_N = 20.0;
  double torque_Nmm = 500.0;
};

/// Reason why a wrench was changed on its way to the device.
enum class WrenchFault : unsigned char {
  none = 0,
  force_clamped = 1,
  torque_clamped = 2,
  force_and_torque_clamped = 3,
  /// The algorithm's wrench was not finite; the sent wrench falls to zero.
  not_finite = 4,
  /// The device's pose was not finite; the sent wrench falls to zero.
  pose_not_finite = 5,
  /// The device moved further in one tick than a hand can; the sent wrench falls to zero.
  pose_jumped = 6,
  /// The tick was too long (GuardSettings::max_tick_s); the sent wrench falls to zero.
  tick_late = 7,
  /// The wrench was modified: faded in, limited in its rate of change, or damped.
  rate_limited = 8,
  /// Zero was sent because no sent wrench reaches the hand (Device::is_driven), or because the tool
  /// was inside bone when driving began and has not left it yet.
  held_back = 9,
};

/// Returns the fault's name: "none", "force clamped", "pose not finite". Recordings store it with their
/// codes.
std::string_view name_of(WrenchFault fault) noexcept;

/// A wrench that may be sent, and why it differs from the requested one.
struct SafeWrench {
  Wrench wrench;
  WrenchFault fault = WrenchFault::none;
};

/// Returns the wrench that may be sent: force and torque each scaled down to its limit, or zero if any
/// component is not finite. Safe in the haptic tick.
SafeWrench make_safe(const Wrench& wrench, const WrenchLimits& limits) noexcept;

/// Limits on the rate of change of force and torque (`approach`); unlimited by default.
struct WrenchRates {
  static constexpr double kAny = std::numeric_limits<double>::infinity();
  double force_N_s = kAny;
  double torque_Nmm_s = kAny;
};

/// Rates for a person's hand; 20 N and 500 N mm fall to zero within 5 ms.
inline constexpr WrenchRates kHandWrenchRates{4000, 1e5};

/// Returns `to`, or the wrench between `from` and `to` that the rates allow to reach in `dt_s`. Safe in the
/// haptic tick.
Wrench approach(const Wrench& from, const Wrench& to, const WrenchRates& rates, double dt_s) noexcept;

/// Returns whether force and torque are exactly zero.
bool is_zero(const Wrench& wrench) noexcept;

}  // namespace osteomill
