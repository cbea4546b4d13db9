#include "osteomill/session/contact_transient.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace osteomill {

namespace {

// Hands are most sensitive to this frequency, and a 1 kHz device can render it.
constexpr double kFrequency_Hz = 200, kDecay_s = 0.006, kLength_s = 0.02;
// Smaller forces do not count as contact, so that device noise does not end a contact-free interval.
constexpr double kContact_N = 1e-3;

}  // namespace

Vec3 ContactTransient::force_N(const Pose& X_WD, const Vec3& contact_W_N, double dt_s) noexcept {
  if (!settings_.on || !contact_W_N.allFinite() || !(dt_s > 0)) return Vec3::Zero();
  const Vec3 velocity_mm_s = (X_WD.position_mm - last_W_mm_.value_or(X_WD.position_mm)) / dt_s;
  last_W_mm_ = X_WD.position_mm;
  since_impact_s_ += dt_s;
  const double contact_N = contact_W_N.norm();
  if (contact_N < kContact_N) {
    free_s_ += dt_s;
  } else if (std::exchange(free_s_, 0) >= kMinFree_s) {
    out_W_ = contact_W_N / contact_N;
    impact_mm_s_ = -velocity_mm_s.dot(out_W_);
    if (impact_mm_s_ >= kMinSpeed_mm_s) since_impact_s_ = 0;
  }
  if (since_impact_s_ >= kLength_s) return Vec3::Zero();
  const double damping_N_s_per_mm = std::min(settings_.damping_N_s_per_mm, settings_.max_N / impact_mm_s_);
  const double in_mm_s = std::clamp(-velocity_mm_s.dot(out_W_), 0.0, impact_mm_s_);
  const double swing = std::sin(std::numbers::pi * kFrequency_Hz * since_impact_s_);
  return damping_N_s_per_mm * in_mm_s * swing * swing * std::exp(-since_impact_s_ / kDecay_s) * out_W_;
}

}  // namespace osteomill
