#include "osteomill/session/passivity_observer.h"

#include <algorithm>

namespace osteomill {

namespace {

// What a handle of 0.1 kg read once a millisecond shows without shaking: a third of m / T.
constexpr double kMostDamping_Ns_per_mm = 0.03;
// How far the hand holds the handle from the burr: by this a turn counts as a motion.
constexpr double kLever_mm = 30;

}  // namespace

void PassivityObserver::move_to(const Pose& X_WD) {
  moved_mm_ = turned_rad_ = Vec3::Zero();
  if (!is_finite(X_WD)) {
    X_WD_.reset();
    return;
  }
  if (X_WD_) {
    moved_mm_ = X_WD.position_mm - X_WD_->position_mm;
    turned_rad_ = rotation_vector(X_WD.orientation * X_WD_->orientation.conjugate());
    energy_given_Nmm_ += sent_.force_N.dot(moved_mm_) + sent_.torque_Nmm.dot(turned_rad_);
  }
  X_WD_ = X_WD;
}

Wrench PassivityObserver::damping(double dt_s) const {
  constexpr double kLever2_mm2 = kLever_mm * kLever_mm;
  const double way2_mm2 = moved_mm_.squaredNorm() + kLever2_mm2 * turned_rad_.squaredNorm();
  if (energy_given_Nmm_ <= 0 || way2_mm2 == 0 || dt_s <= 0) return {};
  const double stiffness_N_per_mm = std::min(energy_given_Nmm_ / way2_mm2, kMostDamping_Ns_per_mm / dt_s);
  return {-stiffness_N_per_mm * moved_mm_, -stiffness_N_per_mm * kLever2_mm2 * turned_rad_};
}

}  // namespace osteomill
