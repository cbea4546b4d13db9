#pragma once

#include <optional>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/session/hand.h"
#include "osteomill/session/milling_entry.h"

namespace osteomill {

/// The test of section 8.2 of the paper as one hand's intent: mill a hole and push the shaft against its
/// edge, then stand in it and hold still.
struct ScriptSettings {
  /// The time that the milling lasts.
  double milling_s = 20.0;
  /// If true, the milling instead lasts until the shaft has leant on bone for `leant_share` of `milling_s`,
  /// or the hand gives up trying to, after three times `milling_s` at the latest.
  bool until_leant = false;
  static constexpr double leant_share = 0.15;
  double holding_s = 20.0;
  /// The hole is deep enough to lean in when the shown burr's tip is this far below the entry.
  static constexpr double depth_mm = 3.0;
  /// The shares of its push that the hand aims for while it feeds the burr in, leans the shaft, and holds.
  static constexpr double feed_push = 0.9;
  static constexpr double lean_push = 0.6;
  static constexpr double hold_push = 0.5;
  /// The least time that the hand takes, at the start of the holding, to come to the push that it then holds.
  /// With `until_leant` it takes until it feels that push and the wall, but no longer than half the holding;
  /// the time beyond `settle_s` makes the holding so much longer.
  double settle_s = 1.0;
};

/// Throws std::invalid_argument, naming the setting, if one is out of range.
void require_valid(const ScriptSettings& settings);

/// The parts of the test that the hand did not achieve in the time it had.
struct ScriptShortfall {
  /// The hole was not deep enough when the hand began to lean.
  bool shallow = false;
  /// The shaft leant on bone for less than it was to.
  bool hardly_leant = false;
  /// The tool left the bone while it leant, or as it settled, and found none any more.
  bool lost = false;
  /// The hand did not come to feel the push that it wanted to hold, with the shaft against the wall.
  bool unsettled = false;
};

/// The stages of the test, in their order.
enum class ScriptStage : unsigned char { approach, feed, lean, settle, hold, done };

/// The pose in which the hand wants the tool to be, and whether the spindle turns.
struct ScriptIntent {
  /// Without tremor.
  Pose X_W_target;
  bool milling = true;
  ScriptStage stage = ScriptStage::approach;
};

/// The hand's intent, tick by tick. It feels its own springs (target against device) and what the device
/// gives it, by which it knows when the shaft meets the wall, and sees the simulated tool, by which it judges
/// how deep the hole is; it never looks at the bone. The same inputs give the same intents.
class MillingScript {
 public:
  MillingScript(const ScriptSettings& settings, const HandSettings& hand, const MillingTool& tool,
                const MillingEntry& entry);

  /// Returns the present intent. At time 0 the device is where the script wants it.
  const ScriptIntent& intent() const noexcept { return intent_; }
  /// Returns the shortfall up to now. Without `until_leant` leaning and settling are not waited for, and not
  /// judged.
  const ScriptShortfall& shortfall() const { return shortfall_; }
  /// Returns the intent at `time_s`, `dt_s` after the last one. `X_WD` is the device's pose, `X_WT` that at
  /// which the simulated tool is shown, `felt` the last wrench on the hand. Safe in the haptic tick.
  const ScriptIntent& step(double time_s, double dt_s, const Pose& X_WD, const Pose& X_WT,
                           const Wrench& felt) noexcept;

 private:
  bool has_leant() const { return leant_s_ >= settings_.leant_share * settings_.milling_s; }
  bool is_push_felt(const Pose& X_WD) const;
  void feel(double dt_s, const Pose& X_WD, const Wrench& felt);
  void advance_stage(double now_s, double dt_s, const Pose& X_WD, const Pose& X_WT);
  void begin(ScriptStage stage, double now_s);
  double max_milling_s() const;
  bool is_milled(double now_s) const;
  bool is_settled(double now_s, const Pose& X_WD) const;
  double shown_depth_mm(const Pose& X_WT) const;
  double felt_push_share(const Pose& X_WD) const;
  double leant_by_rad(const Pose& X_WD) const;
  void move(double dt_s, const Pose& X_WD);
  void push(double share, double slowest_mm_s, double fastest_mm_s, double dt_s, const Pose& X_WD);
  void push_sideways(double dt_s, const Pose& X_WD);
  void lean(double dt_s, const Pose& X_WD);
  Pose target() const;

  ScriptSettings settings_;
  HandSettings hand_;
  MillingTool tool_;
  MillingEntry entry_;
  Quat upright_;
  Vec3 lean_axis_W_;
  // The target: how far along the direction past the entry, how far to the side, and how far leant.
  double along_mm_ = 0;
  double sideways_mm_ = 0;
  double lean_rad_ = 0;
  // The angle to which the device had leant when the shaft met the wall that it is at; the times for which
  // it, and the whole tool, have been free.
  std::optional<double> wall_rad_;
  double shaft_free_s_ = 0;
  double free_s_ = 0;
  bool has_touched_ = false;
  // Since when the present stage, and how long in all the shaft has leant on something.
  double stage_began_s_ = 0;
  double leant_s_ = 0;
  ScriptShortfall shortfall_;
  ScriptIntent intent_;
};

}  // namespace osteomill
