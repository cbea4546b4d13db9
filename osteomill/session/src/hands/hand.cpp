#include "osteomill/session/hand.h"

#include <cmath>

#include "osteomill/base/positive.h"

namespace osteomill {

namespace {

// Squared lever arm that converts translational to rotational values, 1e-3 m^2.
constexpr double kLeverSquared_mm2 = 1000.0;

Vec3 limited(const Vec3& vector, double limit) {
  const double length = vector.norm();
  return length > limit ? Vec3(limit / length * vector) : vector;
}

struct Band {
  double lowest_hz;
  double highest_hz;
  double share_of_power;
};

constexpr Band kPhysiological{8.0, 12.0, 0.9};
constexpr Band kBroad{1.0, 30.0, 0.1};

// Returns sin(2 pi turns) to 1e-9 by a series, because library sines differ in the last bit between machines.
double sine_of_turns(double turns) {
  double folded = turns - std::floor(turns + 0.5);
  if (folded > 0.25) folded = 0.5 - folded;
  if (folded < -0.25) folded = -0.5 - folded;
  const double angle = 6.283185307179586 * folded;
  const double square = angle * angle;
  double sum = 0;
  for (int n = 15; n >= 3; n -= 2) sum = (1.0 + sum) * (-square / static_cast<double>(n * (n - 1)));
  return angle * (1.0 + sum);
}

}  // namespace

void require_valid(const HandSettings& settings) {
  require_not_negative(settings.stiffness_N_per_mm, "hand: its stiffness (N/mm)");
  require_not_negative(settings.damping_Ns_per_mm, "hand: its damping (N s/mm)");
  require_not_negative(settings.torsional_stiffness_Nmm_per_rad, "hand: its torsional stiffness (N mm/rad)");
  require_not_negative(settings.torsional_damping_Nmms_per_rad, "hand: its torsional damping (N mm s/rad)");
  require_not_negative(settings.push_N, "hand: its push (N)");
  require_not_negative(settings.push_lever_mm, "hand: the lever arm of its push (mm)");
  require_not_negative(settings.tremor_mm, "hand: its tremor (mm)");
  require_not_negative(settings.tremor_rad, "hand: its rotational tremor (rad)");
}

Wrench hand_wrench(const HandSettings& hand, const Pose& X_W_target, const Twist& target_velocity,
                   const Pose& X_WD, const Twist& velocity) noexcept {
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

HandSettings with_firmer_grip(HandSettings hand, double firmness) {
  for (double* value : {&hand.stiffness_N_per_mm, &hand.damping_Ns_per_mm,
                        &hand.torsional_stiffness_Nmm_per_rad, &hand.torsional_damping_Nmms_per_rad}) {
    *value *= firmness;
  }
  return hand;
}

Tremor::Tremor(std::uint64_t seed, double rms) {
  require_not_negative(rms, "tremor: its rms");
  SeededRandom random(seed);
  for (auto& sines : axes_) {
    std::size_t next = 0;
    for (const Band& band : {kPhysiological, kBroad}) {
      // One sine at a random frequency in each equal part of the band: the periods are incommensurate, so the
      // signal does not repeat.
      const double part_hz = (band.highest_hz - band.lowest_hz) / kSinesPerBand;
      const double amplitude = rms * std::sqrt(2.0 * band.share_of_power / kSinesPerBand);
      for (int n = 0; n < kSinesPerBand; ++n) {
        const double lowest_hz = band.lowest_hz + part_hz * n;
        const double frequency_hz = random.uniform(lowest_hz, lowest_hz + part_hz);
        const double phase_turns = random.uniform(0.0, 1.0);
        sines[next++] = {amplitude, frequency_hz, phase_turns};
      }
    }
  }
}

Vec3 Tremor::at(double time_s) const noexcept {
  Vec3 displacement = Vec3::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double sum = 0;
    for (const Sine& sine : axes_[axis]) {
      sum += sine.amplitude * sine_of_turns(sine.frequency_hz * time_s + sine.phase_turns);
    }
    displacement[static_cast<Eigen::Index>(axis)] = sum;
  }
  return displacement;
}

}  // namespace osteomill
