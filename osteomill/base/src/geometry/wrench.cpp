#include "osteomill/base/wrench.h"

#include <cmath>

namespace osteomill {

namespace {

bool clamp_length(Vec3& vector, double limit) {
  const double length = vector.norm();
  if (length <= limit) return false;
  vector *= limit / length;
  return true;
}

// Avoids inf * 0 = NaN for an unlimited rate.
Vec3 towards(const Vec3& from, const Vec3& to, double rate, double dt_s) {
  const double most = rate < WrenchRates::kAny ? rate * dt_s : rate;
  const double change = (to - from).norm();
  return change <= most ? to : Vec3(from + most / change * (to - from));
}

}  // namespace

std::string_view name_of(WrenchFault fault) noexcept {
  using enum WrenchFault;
  switch (fault) {
    case none:
      return "none";
    case force_clamped:
      return "force clamped";
    case torque_clamped:
      return "torque clamped";
    case force_and_torque_clamped:
      return "force and torque clamped";
    case not_finite:
      return "wrench not finite";
    case pose_not_finite:
      return "pose not finite";
    case pose_jumped:
      return "pose jumped";
    case tick_late:
      return "tick late";
    case rate_limited:
      return "rate limited";
    case held_back:
      return "held back";
  }
  return "unknown";
}

SafeWrench make_safe(const Wrench& wrench, const WrenchLimits& limits) noexcept {
  // Also catches a norm that overflows: components near the largest double cannot be scaled.
  if (!std::isfinite(wrench.force_N.norm()) || !std::isfinite(wrench.torque_Nmm.norm())) {
    return {Wrench{}, WrenchFault::not_finite};
  }
  SafeWrench safe{wrench, WrenchFault::none};
  const bool force = clamp_length(safe.wrench.force_N, limits.force_N);
  const bool torque = clamp_length(safe.wrench.torque_Nmm, limits.torque_Nmm);
  safe.fault = static_cast<WrenchFault>((force ? 1 : 0) + (torque ? 2 : 0));
  return safe;
}

Wrench approach(const Wrench& from, const Wrench& to, const WrenchRates& rates, double dt_s) noexcept {
  return {towards(from.force_N, to.force_N, rates.force_N_s, dt_s),
          towards(from.torque_Nmm, to.torque_Nmm, rates.torque_Nmm_s, dt_s)};
}

bool is_zero(const Wrench& wrench) noexcept {
  return wrench.force_N.isZero(0) && wrench.torque_Nmm.isZero(0);
}

}  // namespace osteomill
