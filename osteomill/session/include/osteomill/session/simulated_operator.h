#pragma once

#include <cstdint>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/session/device.h"
#include "osteomill/session/hand.h"
#include "osteomill/session/milling_script.h"
#include "osteomill/session/simulated_handle.h"

namespace osteomill {

/// Settings of a SimulatedOperator.
struct OperatorSettings {
  HandleSettings handle;
  HandSettings hand;
  ScriptSettings script;
  /// The seed of the tremor.
  std::uint64_t seed = 1;
};

/// Returns the fields of hand, device and script.
template <>
const std::vector<Field<OperatorSettings>>& fields_of<OperatorSettings>();

/// A device and the hand that holds it, in simulated time: the same settings give the same run on any
/// machine, independent of computing time. `tick_done` advances the simulation. The constructor allocates; no
/// other function allocates, locks, logs or throws.
class SimulatedOperator : public Device {
 public:
  /// Throws std::invalid_argument, naming the setting, if one is out of range, or if hand and handle together
  /// are too stiff for the substep.
  SimulatedOperator(const OperatorSettings& settings, const MillingTool& tool, const MillingEntry& entry);

  /// Returns the pose as read by the encoder.
  Pose read_pose() noexcept override { return handle_.read(); }
  void write_wrench(const Wrench& wrench) noexcept override {
    felt_ = wrench;
    handle_.command(wrench);
  }
  /// Returns whether the current tick is in the milling phase, in which the spindle is on.
  bool is_spindle_requested() const noexcept override { return script_.intent().milling; }
  /// Advances hand and handle by `dt_s`, in whole substeps of the handle; the remainder is kept for the next
  /// call. The operator reads the depth of the hole from `X_WT`. Does nothing if `dt_s` is outside (0, 1 s].
  void tick_done(const Pose& X_WT, double dt_s) noexcept override;

  double time_s() const { return static_cast<double>(substeps_) * handle_.settings().substep_s; }
  ScriptStage stage() const { return script_.intent().stage; }
  const ScriptShortfall& shortfall() const { return script_.shortfall(); }
  /// Returns whether both phases have ended.
  bool finished() const { return stage() == ScriptStage::done; }

  /// Returns the hand's target pose including tremor.
  const Pose& target() const { return X_W_target_; }
  /// Returns the hand's wrench on the handle in the last substep.
  const Wrench& hand_wrench() const { return hand_wrench_; }
  /// Returns the handle with its true state, not rounded by the encoder.
  const SimulatedHandle& handle() const { return handle_; }

 private:
  Pose with_tremor(const Pose& X_W_intended) const;

  HandSettings hand_;
  Tremor tremor_mm_;
  Tremor tremor_rad_;
  MillingScript script_;
  SimulatedHandle handle_;
  Wrench felt_;
  Pose X_W_target_;
  Wrench hand_wrench_;
  std::int64_t substeps_ = 0;
  double time_left_over_s_ = 0;
};

}  // namespace osteomill
