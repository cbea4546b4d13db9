#include "osteomill/operator/milling_script.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "osteomill/numbers/positive.h"

namespace osteomill {

namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::invalid_argument(std::string("milling script: ") + what);
}

bool share(double value) {
  return value >= 0 && value <= 1;
}

// Of what the hand wants to feel, enough to say that it does.
constexpr double kFelt = 0.8;
// What a hand feels of force and of torque (twice a step of the encoder), and for how long it is sure of it.
constexpr double kFelt_N = 0.02;
constexpr double kFelt_Nmm = 0.2;
constexpr double kWallGone_s = 0.2;
// A little more than the time after which a recording counts as without contact to its end.
constexpr double kLost_s = 1.01;

constexpr double kLongestMilling = 3;
// Times are sums of ticks; this keeps a stage from beginning a tick late by a rounding.
constexpr double kRounding_s = 1e-6;

// How far a spring is stretched when it gives `share` of its limit; a spring of no stiffness gives nothing.
double stretch_for(double share, double limit, double stiffness) {
  return stiffness > 0 ? share * limit / stiffness : 0.0;
}

}  // namespace

void require_valid(const ScriptSettings& settings) {
  require(is_not_negative(settings.milling_s) && is_not_negative(settings.holding_s),
          "a phase must not be shorter than 0 s");
  require(is_positive(settings.approach_s), "the approach must take longer than 0 s");
  require(is_not_negative(settings.feed_mm_s) && is_not_negative(settings.lean_rad_s),
          "feed (mm/s) and lean (rad/s) must not be negative");
  require(is_not_negative(settings.depth_mm) && is_not_negative(settings.lean_limit_rad),
          "depth (mm) and the limit of the lean (rad) must not be negative");
  require(share(settings.feed_push_share) && share(settings.latest_lean_share) &&
              share(settings.lean_torque_share) && share(settings.lean_push_share) &&
              share(settings.lean_side_share) && share(settings.hold_side_share) &&
              share(settings.hold_push_share) && share(settings.hold_torque_share) &&
              share(settings.leant_share) && share(settings.longest_lean_share) &&
              share(settings.longest_settle_share),
          "a share must lie in [0, 1]");
  require(is_not_negative(settings.settle_s), "settling must not take less than 0 s");
  require(
      is_not_negative(settings.push_correction_per_s) && is_not_negative(settings.torque_correction_per_s),
      "a correction (1/s) must not be negative");
}

MillingScript::MillingScript(const ScriptSettings& settings, const HandSettings& hand,
                             const MillingTool& tool, const MillingEntry& entry)
    : settings_(settings), hand_(hand), tool_(tool), entry_(entry) {
  require_valid(settings);
  require_valid(hand);
  require_valid(tool);
  const Pose start = pose_above(entry, tool, kStartAbove_mm);
  upright_ = start.orientation;
  // About this axis the shaft, which points against the direction, turns towards the lateral side.
  lean_axis_W_ = (-entry.direction_W).cross(entry.lateral_W).normalized();
  along_mm_ = entry.direction_W.dot(start.position_mm - entry.point_W);
  intent_.X_W_target = target();
  intent_.milling = settings.milling_s > 0;
}

double MillingScript::shown_depth_mm(const Pose& X_WT) const {
  return entry_.direction_W.dot(X_WT.position_mm - entry_.point_W) + tool_.burr_radius_mm;
}

// Of the hand's push and of its torque, what its springs give.
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

double MillingScript::longest_milling_s() const {
  return settings_.until_leant ? kLongestMilling * settings_.milling_s : settings_.milling_s;
}

bool MillingScript::is_milled(double now_s) const {
  if (now_s >= longest_milling_s()) return true;
  return settings_.until_leant && intent_.stage == ScriptStage::lean &&
         (shortfall_.lost || has_leant() ||
          now_s - stage_began_s_ >= settings_.longest_lean_share * settings_.milling_s);
}

bool MillingScript::is_settled(double now_s, const Pose& X_WD) const {
  const double settling_s = now_s - stage_began_s_;
  if (settling_s < std::min(settings_.settle_s, settings_.holding_s)) return false;
  if (!settings_.until_leant || shortfall_.lost ||
      settling_s >= settings_.longest_settle_share * settings_.holding_s)
    return true;
  return feels_what_it_holds(X_WD);
}

bool MillingScript::feels_what_it_holds(const Pose& X_WD) const {
  return felt_push_share(X_WD) >= kFelt * settings_.hold_push_share && wall_rad_;
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
    shortfall_.unsettled = settings_.until_leant && !shortfall_.lost && !feels_what_it_holds(X_WD);
    begin(ScriptStage::hold, now_s);
  }
  if (intent_.stage == ScriptStage::hold &&
      now_s - stage_began_s_ >= settings_.holding_s - settings_.settle_s) {
    begin(ScriptStage::done, now_s);
  }
  if (intent_.stage >= ScriptStage::settle) return;
  const double latest_s = settings_.latest_lean_share * longest_milling_s();
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
  const double rate_mm_s = settings_.push_correction_per_s * (wanted_mm - felt_mm);
  along_mm_ += dt_s * std::clamp(rate_mm_s, slowest_mm_s, fastest_mm_s);
}

void MillingScript::push_sideways(double share, double dt_s, const Pose& X_WD) {
  const double wanted_mm = stretch_for(share, hand_.push_N, hand_.stiffness_N_per_mm);
  const double felt_mm = sideways_mm_ - entry_.lateral_W.dot(X_WD.position_mm - entry_.point_W);
  const double rate_mm_s = settings_.push_correction_per_s * (wanted_mm - felt_mm);
  sideways_mm_ += dt_s * std::clamp(rate_mm_s, -settings_.feed_mm_s, settings_.feed_mm_s);
  // Where nothing resists (a burr that slides over bone too hard for it) the target must not wander off.
  sideways_mm_ = std::clamp(sideways_mm_, 0.0, wanted_mm);
}

void MillingScript::lean(double share, double dt_s, const Pose& X_WD) {
  const double wanted_rad =
      stretch_for(share, torque_limit_Nmm(hand_), hand_.torsional_stiffness_Nmm_per_rad);
  const double felt_rad =
      lean_axis_W_.dot(rotation_vector(target().orientation * X_WD.orientation.conjugate()));
  const double rate_rad_s = settings_.torque_correction_per_s * (wanted_rad - felt_rad);
  lean_rad_ += dt_s * std::clamp(rate_rad_s, -settings_.lean_rad_s, settings_.lean_rad_s);
  const double limit_rad =
      settings_.until_leant && wall_rad_ ? *wall_rad_ + wanted_rad : settings_.lean_limit_rad;
  lean_rad_ = std::clamp(lean_rad_, 0.0, std::clamp(limit_rad, 0.0, settings_.lean_limit_rad));
}

Pose MillingScript::target() const {
  return {entry_.point_W + along_mm_ * entry_.direction_W + sideways_mm_ * entry_.lateral_W,
          (quaternion_from_rotation_vector(lean_rad_ * lean_axis_W_) * upright_).normalized()};
}

void MillingScript::move(double dt_s, const Pose& X_WD) {
  const double feed_mm_s = settings_.feed_mm_s;
  switch (intent_.stage) {
    case ScriptStage::approach:
      push(settings_.feed_push_share, 0.0, kStartAbove_mm / settings_.approach_s, dt_s, X_WD);
      break;
    case ScriptStage::feed:
      push(settings_.feed_push_share, 0.0, feed_mm_s, dt_s, X_WD);
      break;
    case ScriptStage::lean:
      push(settings_.lean_push_share, -feed_mm_s, feed_mm_s, dt_s, X_WD);
      push_sideways(settings_.lean_side_share, dt_s, X_WD);
      lean(settings_.lean_torque_share, dt_s, X_WD);
      break;
    case ScriptStage::settle:
      push(settings_.hold_push_share, -feed_mm_s, feed_mm_s, dt_s, X_WD);
      push_sideways(settings_.hold_side_share, dt_s, X_WD);
      lean(settings_.hold_torque_share, dt_s, X_WD);
      break;
    case ScriptStage::hold:
    case ScriptStage::done:
      break;
  }
}

const ScriptIntent& MillingScript::step(double time_s, double dt_s, const Pose& X_WD, const Pose& X_WT,
                                        const Wrench& felt) {
  feel(dt_s, X_WD, felt);
  advance_stage(time_s + kRounding_s, dt_s, X_WD, X_WT);
  // A hand whose tool is lost stays where it is.
  if (!shortfall_.lost) move(dt_s, X_WD);
  intent_.milling = intent_.stage < ScriptStage::settle;
  intent_.X_W_target = target();
  return intent_;
}

}  // namespace osteomill
