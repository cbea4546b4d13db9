#include "osteomill/operator/hand.h"

#include <cmath>
#include <stdexcept>
#include <string>

#include "osteomill/numbers/positive.h"
#include "osteomill/operator/seeded_random.h"

namespace osteomill {

namespace {

// The square of the lever by which rotation follows translation, 1e-3 m^2.
constexpr double kLeverSquared_mm2 = 1000.0;

Vec3 limited(const Vec3& vector, double limit) {
  const double length = vector.norm();
  return length > limit ? Vec3(limit / length * vector) : vector;
}

}  // namespace

void require_valid(const HandSettings& settings) {
  require_not_negative(settings.stiffness_N_per_mm, "hand: its stiffness (N/mm)");
  require_not_negative(settings.damping_Ns_per_mm, "hand: its damping (N s/mm)");
  require_not_negative(settings.torsional_stiffness_Nmm_per_rad, "hand: its torsional stiffness (N mm/rad)");
  require_not_negative(settings.torsional_damping_Nmms_per_rad, "hand: its torsional damping (N mm s/rad)");
  require_not_negative(settings.push_N, "hand: its push (N)");
  require_not_negative(settings.push_lever_mm, "hand: its push's lever (mm)");
  require_not_negative(settings.tremor_mm, "hand: its tremor (mm)");
  require_not_negative(settings.tremor_rad, "hand: its tremor's turning (rad)");
}

Wrench hand_wrench(const HandSettings& hand, const Pose& X_W_target, const Twist& target_velocity,
                   const Pose& X_WD, const Twist& velocity) {
  const Vec3 stretch_mm = X_W_target.position_mm - X_WD.position_mm;
  const Vec3 twist_rad = rotation_vector(X_W_target.orientation * X_WD.orientation.conjugate());
  const Vec3 slip_mm_s = target_velocity.linear_mm_s - velocity.linear_mm_s;
  const Vec3 slip_rad_s = target_velocity.angular_rad_s - velocity.angular_rad_s;
  return {limited(hand.stiffness_N_per_mm * stretch_mm, hand.push_N) + hand.damping_Ns_per_mm * slip_mm_s,
          limited(hand.torsional_stiffness_Nmm_per_rad * twist_rad, torque_limit_Nmm(hand)) +
              hand.torsional_damping_Nmms_per_rad * slip_rad_s};
}

HandSettings random_hand(std::uint64_t seed) {
  SeededRandom random(seed);
  HandSettings hand;
  hand.stiffness_N_per_mm = random.uniform(0.135, 1.0);
  hand.damping_Ns_per_mm = random.uniform(0.005, 0.010);
  hand.torsional_stiffness_Nmm_per_rad = kLeverSquared_mm2 * hand.stiffness_N_per_mm;
  hand.torsional_damping_Nmms_per_rad = kLeverSquared_mm2 * hand.damping_Ns_per_mm;
  return hand;
}

HandSettings gripping(HandSettings hand, double firmness) {
  for (double* value : {&hand.stiffness_N_per_mm, &hand.damping_Ns_per_mm,
                        &hand.torsional_stiffness_Nmm_per_rad, &hand.torsional_damping_Nmms_per_rad}) {
    *value *= firmness;
  }
  return hand;
}

}  // namespace osteomill
