#pragma once

#include <optional>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/haptics/milling_tool.h"
#include "osteomill/session/hand.h"
#include "osteomill/session/milling_entry.h"

namespace osteomill {

/// The test of section 8.2 of the paper: mill a hole, lean the shaft against its edge, then hold still in it.
struct ScriptSettings {
  /// Duration of the milling phase.
  double milling_s = 20.0;
  /// If true, milling instead lasts until the shaft has leant on bone for `leant_share` of `milling_s`, or
  /// the hand gives up, at the latest after three times `milling_s`.
  bool until_leant = false;
  static constexpr double leant_share = 0.15;
  double holding_s = 20.0;
  /// Depth of the shown burr's tip below the entry at which the hand begins to lean.
  static constexpr double depth_mm = 3.0;
  /// Target push as a fraction of HandSettings::push_N while feeding, leaning and holding.
  static constexpr double feed_push = 0.9;
  static constexpr double lean_push = 0.6;
  static constexpr double hold_push = 0.5;
  /// Minimum time at the start of the holding in which the hand settles to the push that it then holds. With
  /// `until_leant` settling lasts until the hand feels that push and the wall, at most half the holding; time
  /// beyond `settle_s` extends the holding.
  double settle_s = 1.0;
};

/// Throws std::invalid_argument, naming the setting, if one is out of range.
void require_valid(const ScriptSettings& settings);

/// Goals of the test that the hand did not reach in time.
struct ScriptShortfall {
  /// The hole was not deep enough when the hand began to lean.
  bool shallow = false;
  /// The shaft leant on bone for less than the required time.
  bool hardly_leant = false;
  /// The tool left the bone while leaning or settling and did not touch it again.
  bool lost = false;
  /// The hand did not reach the push to hold with the shaft against the wall.
  bool unsettled = false;
};

/// The stages of the test, in their order.
enum class ScriptStage : unsigned char { approach, feed, lean, settle, hold, done };

/// Target pose of the tool, and whether the spindle is on.
struct ScriptIntent {
  /// Without tremor.
  Pose X_W_target;
  bool milling = true;
  ScriptStage stage = ScriptStage::approach;
};

/// Computes the hand's intent tick by tick. Inputs are the hand's own springs (target against device), the
/// device's wrench, which reveals when the shaft touches the wall, and the pose of the simulated tool, which
/// gives the depth of the hole; the bone itself is not used. Deterministic.
class MillingScript {
 public:
  MillingScript(const ScriptSettings& settings, const HandSettings& hand, const MillingTool& tool,
                const MillingEntry& entry);

  /// Returns the current intent. At time 0 its target is the initial device pose.
  const ScriptIntent& intent() const noexcept { return intent_; }
  /// Returns the shortfall so far. `hardly_leant` and `unsettled` are evaluated only with `until_leant`.
  const ScriptShortfall& shortfall() const { return shortfall_; }
  /// Advances by `dt_s` and returns the intent at `time_s`. `X_WD` is the device's pose, `X_WT` the simulated
  /// tool's, `felt` the last wrench on the hand. Safe in the haptic tick.
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
  // Target: distance along the direction past the entry, sideways offset, and lean angle.
  double along_mm_ = 0;
  double sideways_mm_ = 0;
  double lean_rad_ = 0;
  // Lean angle of the device when the shaft met the current wall; times for which the shaft, and the whole
  // tool, have been free.
  std::optional<double> wall_rad_;
  double shaft_free_s_ = 0;
  double free_s_ = 0;
  bool has_touched_ = false;
  // Start of the current stage, and total time for which the shaft has leant on something.
  double stage_began_s_ = 0;
  double leant_s_ = 0;
  ScriptShortfall shortfall_;
  ScriptIntent intent_;
};

}  // namespace osteomill
