#include "osteomill/session/simulated_operator.h"

#include <cmath>
#include <stdexcept>
#include <utility>

namespace osteomill {

namespace {

constexpr double kMaxTick_s = 1.0;
// Decorrelates the tremor of a hand's rotation from that of its displacement.
constexpr std::uint64_t kTurning = 0x9e3779b97f4a7c15;

// Stability bound of semi-implicit Euler (simulated_handle.h), reduced from 4 to 3 to leave a margin for the
// wall.
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
  X_W_target_ = with_tremor(script_.intent().X_W_target);
}

Pose SimulatedOperator::with_tremor(const Pose& X_W_intended) const {
  const Quat turn = quaternion_from_rotation_vector(tremor_rad_.at(time_s()));
  return {X_W_intended.position_mm + tremor_mm_.at(time_s()), (turn * X_W_intended.orientation).normalized()};
}

void SimulatedOperator::tick_done(const Pose& X_WT, double dt_s) noexcept {
  if (!(dt_s > 0 && dt_s <= kMaxTick_s)) return;
  const double substep_s = handle_.settings().substep_s;
  const double owed_s = time_left_over_s_ + dt_s;
  // The tolerance keeps rounding from dropping a substep.
  const auto count = static_cast<std::int64_t>(std::floor(owed_s / substep_s + 1e-6));
  time_left_over_s_ = owed_s - static_cast<double>(count) * substep_s;
  if (count < 1) return;

  // Interpolates the target linearly to the script's target at the end of this time; jumps at the tick rate
  // would be felt as a buzz.
  substeps_ += count;
  const double passed_s = static_cast<double>(count) * substep_s;
  const Pose from = X_W_target_;
  const Pose to = with_tremor(script_.step(time_s(), passed_s, handle_.pose(), X_WT, felt_).X_W_target);
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

namespace {

constexpr NumberRange kPositive = NumberRange::positive(), kNotNegative = NumberRange::not_negative();

std::vector<Field<HandSettings>> hand_fields() {
  using H = HandSettings;
  return {
      field<H>({"hand.push", "N", kPositive, "Largest force with which the hand pushes", 0, "push"},
               &H::push_N),
      field<H>({"hand.push_lever", "mm", kNotNegative,
                "Lever arm of the hand's largest torque, which is the largest push times this"},
               &H::push_lever_mm),
      field<H>({"hand.stiffness", "N/mm", kPositive, "Stiffness of the hand; with several seeds it is drawn",
                0, "hand-stiffness"},
               &H::stiffness_N_per_mm),
      field<H>({"hand.damping", "N s/mm", kPositive, "Damping of the hand; with several seeds it is drawn", 0,
                "hand-damping"},
               &H::damping_Ns_per_mm),
      field<H>(
          {"hand.torsional_stiffness", "N mm/rad", kPositive,
           "Torsional stiffness of the hand; with several seeds it is drawn", 0, "hand-torsional-stiffness"},
          &H::torsional_stiffness_Nmm_per_rad),
      field<H>({"hand.torsional_damping", "N mm s/rad", kPositive,
                "Torsional damping of the hand; with several seeds it is drawn", 0, "hand-torsional-damping"},
               &H::torsional_damping_Nmms_per_rad),
      field<H>({"hand.tremor", "mm", kNotNegative, "Tremor of the hand along each axis, rms"}, &H::tremor_mm),
      field<H>({"hand.tremor_turn", "rad", kNotNegative, "Tremor of the hand about each axis, rms"},
               &H::tremor_rad),
  };
}

std::vector<Field<HandleSettings>> handle_fields() {
  using H = HandleSettings;
  return {
      field<H>({"device.mass", "kg", kPositive, "Mass of the handle", 0, "device-mass"}, &H::mass_kg),
      field<H>(
          {"device.inertia", "kg m^2", kPositive, "Moment of inertia of the handle", 0, "device-inertia"},
          &H::inertia_kg_m2),
      field<H>({"device.position_step", "mm", kNotNegative, "Encoder resolution in translation"},
               &H::position_step_mm),
      field<H>({"device.rotation_step", "rad", kNotNegative, "Encoder resolution in rotation"},
               &H::rotation_step_rad),
      field<H>({"device.force_delay", "s", kPositive, "Delay from sending a wrench to its effect", 0,
                "device-delay"},
               &H::force_delay_s),
      field<H>(
          {"device.force_limit", "N", kNotNegative, "Largest force of the motors", kMayBeAbsent},
          [](auto& h) -> auto& { return h.limits.force_N; }),
      field<H>(
          {"device.torque_limit", "N mm", kNotNegative, "Largest torque of the motors", kMayBeAbsent},
          [](auto& h) -> auto& { return h.limits.torque_Nmm; }),
      field<H>({"device.substep", "s", kPositive, "Step of the simulated device's integration"},
               &H::substep_s),
  };
}

std::vector<Field<ScriptSettings>> script_fields() {
  using S = ScriptSettings;
  return {
      {{"", "s", kPositive,
        "Duration of each phase, milling and holding (approximate in compare; docs/algorithms.md)", 0,
        "seconds"},
       [](const S& s) { return s.milling_s; },
       [](S& s, double value) { s.milling_s = s.holding_s = value; }},
      field<S>({"script.milling", "s", kNotNegative, "Duration of the milling"}, &S::milling_s),
      field<S>({"script.until-leant", "", NumberRange::on_or_off(), "Mill until the shaft has leant on bone"},
               &S::until_leant),
      field<S>({"script.holding", "s", kNotNegative, "Duration of the holding"}, &S::holding_s),
      field<S>({"script.settle", "s", kNotNegative,
                "Time for the hand to settle before the holding is measured", kMayBeAbsent},
               &S::settle_s),
  };
}

}  // namespace

template <>
const std::vector<Field<OperatorSettings>>& fields_of<OperatorSettings>() {
  using O = OperatorSettings;
  static const std::vector<Field<O>> all =
      joined<O>({fields_within<O>(&O::script, script_fields()), fields_within<O>(&O::hand, hand_fields()),
                 fields_within<O>(&O::handle, handle_fields())});
  return all;
}

}  // namespace osteomill
