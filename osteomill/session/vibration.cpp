#include "osteomill/session/vibration.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteomill {

namespace {

constexpr double kMax_hz = 250;

}  // namespace

double vibration_hz(double spindle_speed_rpm) {
  const double turns_per_s = spindle_speed_rpm / 60;
  return turns_per_s / std::max(1.0, std::ceil(turns_per_s / kMax_hz));
}

Vec3 Vibration::force_N(const Pose& X_WT, double burr_force_N, double dt_s) {
  if (!settings_.on || !(burr_force_N > 0) || !std::isfinite(burr_force_N)) return Vec3::Zero();
  turns_ += hz_ * dt_s;
  turns_ -= std::floor(turns_);
  const double amplitude_N = std::min(settings_.force_share * burr_force_N, settings_.max_N);
  const double angle = 2 * std::numbers::pi * turns_;
  return X_WT.orientation * Vec3(amplitude_N * std::cos(angle), amplitude_N * std::sin(angle), 0);
}

}  // namespace osteomill
