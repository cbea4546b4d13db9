#include "osteomill/operator/simulated_operator.h"

#include <cmath>
#include <stdexcept>

namespace osteomill {

namespace {

constexpr double kLongestTick_s = 1.0;
// Of the seed that makes a hand's turning another random signal than its displacement.
constexpr std::uint64_t kTurning = 0x9e3779b97f4a7c15;

// The bound of semi-implicit Euler (simulated_handle.h), with a fourth of it left for the wall.
void require_integrable(const HandleSettings& handle, const HandSettings& hand) {
  const double h = handle.substep_s;
  // In SI units: N/m, N s/m, N m/rad, N m s/rad.
  const double along = h * 1e3 * (h * hand.stiffness_N_per_mm + 2 * hand.damping_Ns_per_mm) / handle.mass_kg;
  const double about = h * 1e-3 *
                       (h * hand.torsional_stiffness_Nmm_per_rad + 2 * hand.torsional_damping_Nmms_per_rad) /
                       handle.inertia_kg_m2;
  if (!(along < 3 && about < 3)) {
    throw std::invalid_argument(
        "simulated operator: the hand is too stiff or damped for the handle's substep");
  }
}

}  // namespace

SimulatedOperator::SimulatedOperator(const OperatorSettings& settings, const MillingTool& tool,
                                     const MillingEntry& entry)
    : hand_(settings.hand),
      tremor_mm_(settings.seed, settings.hand.tremor_mm),
      tremor_rad_(settings.seed ^ kTurning, settings.hand.tremor_rad),
      script_(settings.script, settings.hand, tool, entry),
      handle_(settings.handle, script_.intent().X_W_target) {
  require_integrable(settings.handle, settings.hand);
  X_W_target_ = trembling(script_.intent().X_W_target);
}

Pose SimulatedOperator::trembling(const Pose& X_W_intended) const {
  const Quat turn = quaternion_from_rotation_vector(tremor_rad_.at(time_s()));
  return {X_W_intended.position_mm + tremor_mm_.at(time_s()), (turn * X_W_intended.orientation).normalized()};
}

void SimulatedOperator::tick_done(const Pose& X_WT, double dt_s) {
  if (!(dt_s > 0 && dt_s <= kLongestTick_s)) return;
  const double substep_s = handle_.settings().substep_s;
  const double owed_s = time_left_over_s_ + dt_s;
  // A rounding must not cost a substep.
  const auto count = static_cast<std::int64_t>(std::floor(owed_s / substep_s + 1e-6));
  time_left_over_s_ = owed_s - static_cast<double>(count) * substep_s;
  if (count < 1) return;

  // The target goes from where it is to where the script wants it at the end of this time, in a straight line
  // and at one speed: jumps at the tick's rate would be felt as a buzz.
  substeps_ += count;
  const double passed_s = static_cast<double>(count) * substep_s;
  const Pose from = X_W_target_;
  const Pose to = trembling(script_.step(time_s(), passed_s, handle_.pose(), X_WT, felt_).X_W_target);
  const Vec3 turn_rad = rotation_vector(to.orientation * from.orientation.conjugate());
  const Twist speed{(to.position_mm - from.position_mm) / passed_s, turn_rad / passed_s};
  for (std::int64_t n = 0; n < count; ++n) {
    const double done_s = static_cast<double>(n) * substep_s;
    X_W_target_.position_mm = from.position_mm + done_s * speed.linear_mm_s;
    X_W_target_.orientation =
        (quaternion_from_rotation_vector(done_s * speed.angular_rad_s) * from.orientation).normalized();
    hand_wrench_ = osteomill::hand_wrench(hand_, X_W_target_, speed, handle_.pose(), handle_.velocity());
    handle_.advance(hand_wrench_);
  }
  X_W_target_ = to;
}

}  // namespace osteomill
