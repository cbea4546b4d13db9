#include "osteomill/session/milling_script.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "osteomill/base/positive.h"

namespace osteomill {

namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("milling script: ") + what);
}

// Sideways force towards the rim, as a fraction of the push. Leaning by torque alone would press the burr
// into the opposite wall as hard as the shaft into the rim, and mill that wall away instead of loading the
// edge.
constexpr double kSide = 0.6;
// Lean torque as a fraction of the torque limit. With `until_leant` the lean angle is limited to the angle at
// which the shaft met the wall plus the stretch for this torque, in case the wall gives way.
constexpr double kTorque = 0.8;
constexpr double kApproach_s = 1.0;
constexpr double kFeed_mm_s = 2.0;
constexpr double kLean_rad_s = 0.14;  // 8 degrees a second
// Maximum lean angle of the target (35 degrees).
constexpr double kLeanLimit_rad = 0.61;
// Fraction of the (maximum) milling time after which the hand leans whatever the depth of the hole; maximum
// leaning time as a fraction of `milling_s`; maximum settling time as a fraction of the holding.
constexpr double kLatestLeanShare = 0.6;
constexpr double kMaxLeanShare = 0.4;
constexpr double kMaxSettleShare = 0.5;
// Rates at which the hand corrects the stretch and twist of its spring. Slow against the natural frequency of
// hand and handle (41 rad/s), so that the script neither damps nor excites it.
constexpr double kPushCorrection_per_s = 4.0;
constexpr double kTorqueCorrection_per_s = 8.0;

// Fraction of the push to hold from which the hand counts as feeling it.
constexpr double kFelt = 0.8;
// Smallest force and torque that the hand feels (two encoder steps), and the time without contact after which
// the wall counts as gone.
constexpr double kFelt_N = 0.02;
constexpr double kFelt_Nmm = 0.2;
constexpr double kWallGone_s = 0.2;
// Slightly more than the time after which a recording counts as having no further contact.
constexpr double kLost_s = 1.01;

constexpr double kMaxMillingFactor = 3;
// Tolerance for times, which are sums of ticks, so that rounding does not delay a stage by a tick.
constexpr double kRounding_s = 1e-6;

// Returns the stretch at which a spring gives `share` of its limit; 0 if it has no stiffness.
double stretch_for(double share, double limit, double stiffness) {
  return stiffness > 0 ? share * limit / stiffness : 0.0;
}

}  // namespace

void require_valid(const ScriptSettings& settings) {
  require(is_not_negative(settings.milling_s) && is_not_negative(settings.holding_s),
          "a phase must not be shorter than 0 s");
  require(is_not_negative(settings.settle_s), "settling must not take less than 0 s");
}

MillingScript::MillingScript(const ScriptSettings& settings, const HandSettings& hand,
                             const MillingTool& tool, const MillingEntry& entry)
    : settings_(settings), hand_(hand), tool_(tool), entry_(entry) {
  require_valid(settings);
  require_valid(hand);
  require_valid(tool);
  const Pose start = pose_above(entry, tool, kStartAbove_mm);
  upright_ = start.orientation;
  // Rotation about this axis leans the shaft, which points against the direction, towards the lateral side.
  lean_axis_W_ = (-entry.direction_W).cross(entry.lateral_W).normalized();
  along_mm_ = entry.direction_W.dot(start.position_mm - entry.point_W);
  intent_.X_W_target = target();
  intent_.milling = settings.milling_s > 0;
}

double MillingScript::shown_depth_mm(const Pose& X_WT) const {
  return entry_.direction_W.dot(X_WT.position_mm - entry_.point_W) + tool_.burr_radius_mm;
}

// Returns the force of the hand's spring along the direction as a fraction of its push.
double MillingScript::felt_push_share(const Pose& X_WD) const {
  const double stretch_mm = along_mm_ - entry_.direction_W.dot(X_WD.position_mm - entry_.point_W);
  return hand_.push_N > 0 ? stretch_mm * hand_.stiffness_N_per_mm / hand_.push_N : 0;
}

double MillingScript::leant_by_rad(const Pose& X_WD) const {
  return lean_axis_W_.dot(rotation_vector(X_WD.orientation * upright_.conjugate()));
}

void MillingScript::feel(double dt_s, const Pose& X_WD, const Wrench& felt) {
  const bool shaft_touches = felt.torque_Nmm.norm() >= kFelt_Nmm;
  shaft_free_s_ = shaft_touches ? 0 : shaft_free_s_ + dt_s;
  const bool touches = shaft_touches || felt.force_N.norm() >= kFelt_N;
  has_touched_ |= touches;
  free_s_ = touches ? 0 : free_s_ + dt_s;
  if (shaft_touches && !wall_rad_) wall_rad_ = leant_by_rad(X_WD);
  if (shaft_free_s_ >= kWallGone_s) wall_rad_.reset();
}

double MillingScript::max_milling_s() const {
  return settings_.until_leant ? kMaxMillingFactor * settings_.milling_s : settings_.milling_s;
}

bool MillingScript::is_milled(double now_s) const {
  if (now_s >= max_milling_s()) return true;
  return settings_.until_leant && intent_.stage == ScriptStage::lean &&
         (shortfall_.lost || has_leant() || now_s - stage_began_s_ >= kMaxLeanShare * settings_.milling_s);
}

bool MillingScript::is_settled(double now_s, const Pose& X_WD) const {
  const double settling_s = now_s - stage_began_s_;
  if (settling_s < std::min(settings_.settle_s, settings_.holding_s)) return false;
  if (!settings_.until_leant || shortfall_.lost || settling_s >= kMaxSettleShare * settings_.holding_s)
    return true;
  return is_push_felt(X_WD);
}

bool MillingScript::is_push_felt(const Pose& X_WD) const {
  return felt_push_share(X_WD) >= kFelt * ScriptSettings::hold_push && wall_rad_;
}

void MillingScript::begin(ScriptStage stage, double now_s) {
  intent_.stage = stage;
  stage_began_s_ = now_s - kRounding_s;
}

void MillingScript::advance_stage(double now_s, double dt_s, const Pose& X_WD, const Pose& X_WT) {
  const bool is_milling = intent_.stage < ScriptStage::settle;
  const bool is_leaning = intent_.stage == ScriptStage::lean || intent_.stage == ScriptStage::settle;
  shortfall_.lost |= is_leaning && has_touched_ && free_s_ >= kLost_s;
  if (is_milling && is_milled(now_s)) {
    shortfall_.shallow |= intent_.stage < ScriptStage::lean;
    shortfall_.hardly_leant = settings_.until_leant && !shortfall_.lost && !has_leant();
    begin(ScriptStage::settle, now_s);
  }
  if (intent_.stage == ScriptStage::settle && is_settled(now_s, X_WD)) {
    shortfall_.unsettled = settings_.until_leant && !shortfall_.lost && !is_push_felt(X_WD);
    begin(ScriptStage::hold, now_s);
  }
  if (intent_.stage == ScriptStage::hold &&
      now_s - stage_began_s_ >= settings_.holding_s - settings_.settle_s) {
    begin(ScriptStage::done, now_s);
  }
  if (intent_.stage >= ScriptStage::settle) return;
  const double latest_s = kLatestLeanShare * max_milling_s();
  if (intent_.stage == ScriptStage::lean) {
    if (shaft_free_s_ == 0) leant_s_ += dt_s;
  } else if (shown_depth_mm(X_WT) >= settings_.depth_mm || now_s >= latest_s) {
    shortfall_.shallow = shown_depth_mm(X_WT) < settings_.depth_mm;
    begin(ScriptStage::lean, now_s);
  } else if (along_mm_ >= -tool_.burr_radius_mm) {
    intent_.stage = ScriptStage::feed;
  }
}

void MillingScript::push(double share, double slowest_mm_s, double fastest_mm_s, double dt_s,
                         const Pose& X_WD) {
  const double wanted_mm = stretch_for(share, hand_.push_N, hand_.stiffness_N_per_mm);
  const double felt_mm = along_mm_ - entry_.direction_W.dot(X_WD.position_mm - entry_.point_W);
  const double rate_mm_s = kPushCorrection_per_s * (wanted_mm - felt_mm);
  along_mm_ += dt_s * std::clamp(rate_mm_s, slowest_mm_s, fastest_mm_s);
}

void MillingScript::push_sideways(double dt_s, const Pose& X_WD) {
  const double wanted_mm = stretch_for(kSide, hand_.push_N, hand_.stiffness_N_per_mm);
  const double felt_mm = sideways_mm_ - entry_.lateral_W.dot(X_WD.position_mm - entry_.point_W);
  const double rate_mm_s = kPushCorrection_per_s * (wanted_mm - felt_mm);
  sideways_mm_ += dt_s * std::clamp(rate_mm_s, -kFeed_mm_s, kFeed_mm_s);
  // Without resistance (a burr that slides over bone too hard for it) the target must not drift away.
  sideways_mm_ = std::clamp(sideways_mm_, 0.0, wanted_mm);
}

void MillingScript::lean(double dt_s, const Pose& X_WD) {
  const double wanted_rad =
      stretch_for(kTorque, torque_limit_Nmm(hand_), hand_.torsional_stiffness_Nmm_per_rad);
  const double felt_rad =
      lean_axis_W_.dot(rotation_vector(target().orientation * X_WD.orientation.conjugate()));
  const double rate_rad_s = kTorqueCorrection_per_s * (wanted_rad - felt_rad);
  lean_rad_ += dt_s * std::clamp(rate_rad_s, -kLean_rad_s, kLean_rad_s);
  const double limit_rad = settings_.until_leant && wall_rad_ ? *wall_rad_ + wanted_rad : kLeanLimit_rad;
  lean_rad_ = std::clamp(lean_rad_, 0.0, std::clamp(limit_rad, 0.0, kLeanLimit_rad));
}

Pose MillingScript::target() const {
  return {entry_.point_W + along_mm_ * entry_.direction_W + sideways_mm_ * entry_.lateral_W,
          (quaternion_from_rotation_vector(lean_rad_ * lean_axis_W_) * upright_).normalized()};
}

void MillingScript::move(double dt_s, const Pose& X_WD) {
  switch (intent_.stage) {
    case ScriptStage::approach:
      push(ScriptSettings::feed_push, 0.0, kStartAbove_mm / kApproach_s, dt_s, X_WD);
      break;
    case ScriptStage::feed:
      push(ScriptSettings::feed_push, 0.0, kFeed_mm_s, dt_s, X_WD);
      break;
    case ScriptStage::lean:
    case ScriptStage::settle:
      push(intent_.stage == ScriptStage::lean ? ScriptSettings::lean_push : ScriptSettings::hold_push,
           -kFeed_mm_s, kFeed_mm_s, dt_s, X_WD);
      push_sideways(dt_s, X_WD);
      lean(dt_s, X_WD);
      break;
    case ScriptStage::hold:
    case ScriptStage::done:
      break;
  }
}

const ScriptIntent& MillingScript::step(double time_s, double dt_s, const Pose& X_WD, const Pose& X_WT,
                                        const Wrench& felt) noexcept {
  feel(dt_s, X_WD, felt);
  advance_stage(time_s + kRounding_s, dt_s, X_WD, X_WT);
  // If the tool has lost the bone, the hand stays in place.
  if (!shortfall_.lost) move(dt_s, X_WD);
  intent_.milling = intent_.stage < ScriptStage::settle;
  intent_.X_W_target = target();
  return intent_;
}

}  // namespace osteomill
