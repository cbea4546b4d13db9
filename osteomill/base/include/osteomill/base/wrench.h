#pragma once

#include <limits>
#include <string_view>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Force and torque as they act on the hand, in the axes of the world frame W; the torque is about the burr's
/// centre.
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

/// The greatest force and torque that a device may be asked for.
struct WrenchLimits {
  double force_N = 20.0;
  double torque_Nmm = 500.0;
};

/// Why a wrench was changed on its way to the device.
enum class WrenchFault : unsigned char {
  none = 0,
  force_clamped = 1,
  torque_clamped = 2,
  force_and_torque_clamped = 3,
  /// The algorithm's wrench was not finite; zero was sent.
  not_finite = 4,
  /// The device gave no finite pose; zero was sent.
  pose_not_finite = 5,
  /// The device moved further in a tick than a hand can; zero was sent.
  pose_jumped = 6,
  /// The tick came too late; zero was sent.
  tick_late = 7,
  /// Something else than what was asked for was sent: the wrench is being faded in, was changing too fast, or
  /// is damped.
  rate_limited = 8,
  /// Zero was sent, since nothing that is sent reaches the hand (Device::is_driven), or since the tool was in
  /// bone when it began to and has not left it yet.
  held_back = 9,
};

/// Returns the fault in words: "none", "force clamped", "pose not finite". Recordings name their codes so.
std::string_view name_of(WrenchFault fault) noexcept;

/// A wrench that may be sent, and why it is not the one that was asked for.
struct SafeWrench {
  Wrench wrench;
  WrenchFault fault = WrenchFault::none;
};

/// Returns the wrench that may be sent: force and torque shortened to the limits without turning them, or
/// zero if any component is not finite. Safe in the haptic tick.
SafeWrench make_safe(const Wrench& wrench, const WrenchLimits& limits) noexcept;

/// The limits to how fast the vectors of force and torque may change (`approach`); no limit unless set.
struct WrenchRates {
  static constexpr double kAny = std::numeric_limits<double>::infinity();
  double force_N_s = kAny;
  double torque_Nmm_s = kAny;
};

/// The rates for a person's hand, with which 20 N and 500 N mm are gone within 5 ms.
inline constexpr WrenchRates kHandWrenchRates{4000, 1e5};

/// Returns `to`, or the wrench as far from `from` towards it as the rates allow in `dt_s`. Safe in the haptic
/// tick.
Wrench approach(const Wrench& from, const Wrench& to, const WrenchRates& rates, double dt_s) noexcept;

/// Returns whether force and torque are exactly zero.
bool is_zero(const Wrench& wrench) noexcept;

}  // namespace osteomill
