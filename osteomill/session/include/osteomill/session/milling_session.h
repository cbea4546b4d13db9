#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "osteomill/haptics/haptic_algorithm.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/milling/cutting_reaction.h"
#include "osteomill/milling/no_go_watch.h"
#include "osteomill/session/device.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/session/tick_record.h"
#include "osteomill/session/trajectory.h"

namespace osteomill {

/// Returns the frequency of the vibration force: the spindle's rotation frequency up to 100 Hz, then rising
/// with the logarithm of the speed to 250 Hz at 1e6 rpm. Hands are most sensitive near 250 Hz, and a 1 kHz
/// device can still render it. Strictly increasing.
double vibration_hz(double spindle_speed_rpm);

/// A force that rotates about the shaft while the burr cuts. Safe in the haptic tick.
class Vibration {
 public:
  explicit Vibration(const VibrationSettings& settings) : settings_(settings) {}

  /// Returns the force in W, `dt_s` after the last call, for a burr that cuts with `cutting_N` at the
  /// spindle's actual speed.
  Vec3 force_N(const Pose& X_WT, double cutting_N, double spindle_rpm, double dt_s) noexcept;

 private:
  VibrationSettings settings_;
  double turns_ = 0;
};

/// State from which another session resumes: the pose of the simulated tool, which is outside the bone, the
/// wrench on the hand, and whether the hand was held back (WrenchGuard). Without a tool pose the next session
/// starts at the device's pose, which may be inside bone.
struct SessionHandover {
  std::optional<Pose> X_WT;
  Wrench sent;
  bool held_back = true;
  double spindle_rpm = 0;
};

/// Time and mode of a tick.
struct TickInput {
  /// Start of the tick; only recorded.
  double time_s = 0;
  /// Length of the tick: the time since the previous one, and until the next. Replaced by
  /// MillingSetup::tick_s if it is not a positive number.
  double dt_s = 0;
  /// Additional time since the previous tick because ticks were missed.
  double late_s = 0;
  /// Whether the spindle is on; if not given, Device::is_spindle_requested decides.
  std::optional<bool> spindle_on = {};
  /// If true, the tick computes nothing, and the sent wrench falls to zero; contacts are kept.
  bool paused = false;
};

/// Runs one tool, one bone and one algorithm tick by tick: read the pose, compute, send the wrench, remove
/// bone. The wrench is sent before bone is removed, so that milling does not delay it.
class MillingSession {
 public:
  /// Prepares the algorithm, which may take long. While this session exists, no earlier session may tick on
  /// the same bone, because an algorithm follows only the milling of its own session. Throws
  /// std::invalid_argument if a setting is out of range, the tool cannot work (`require_workable`), or
  /// structures of the bone have a guard that the algorithm does not support.
  MillingSession(std::shared_ptr<Volume> bone, const BoneDensities& densities, const MillingSetup& setup);

  /// Runs one complete haptic tick: reads the device's pose, computes and sends the wrench, removes as much
  /// bone as the sent force allows, and calls Device::tick_done. If the wrench or the pose is not
  /// finite, the sent wrench falls to zero as fast as the guard allows (20 N in 5 ms; at once with
  /// GuardSettings::for_simulation), and the record's fault gives the reason. Real-time safe: no allocation,
  /// lock, log or system call. Only the device may throw; zero is then written to it and the hand is held
  /// back (WrenchGuard::hold_back) before the exception propagates.
  TickRecord tick(Device& device, const TickInput& input) OSTEOMILL_NONBLOCKING;

  /// Returns the guard between the algorithm and the hand. Real-time safe.
  WrenchGuard& guard() { return guard_; }

  /// Resumes where another session ended, whose wrench is still on the hand. Call before the first tick.
  /// Real-time safe.
  void resume_from(const SessionHandover& before) noexcept;
  /// Returns the state from which another session can resume. Call after the last tick.
  SessionHandover handover() const {
    return {last_X_WT_, guard_.sent(), guard_.is_held_back(), spindle_.speed_rpm()};
  }
  /// Treats the next tick as if the device was not driven (Device::is_driven), e.g. after a time without
  /// ticks. Real-time safe.
  void hold_back() noexcept { hold_back_requested_ = true; }

  /// Fades the wrench to zero from the next tick on and keeps it there until the tool is placed. Real-time
  /// safe.
  void fade_out() noexcept { fade_out_requested_ = true; }
  /// Restarts the algorithm in the next tick at the device's pose, which must be free of bone, and discards
  /// all contacts. Real-time safe.
  void place() noexcept { place_requested_ = true; }

  /// Returns the voxels that the last tick changed.
  const VolumeChange& last_change() const { return last_change_; }
  /// Returns HapticStep::intersection_W of the last tick, for display.
  const std::optional<Vec3>& intersection_W() const { return intersection_W_; }
  /// Returns the bone removed since the start, in mm^3 of reference density.
  double removed_mm3() const { return removed_mm3_; }
  /// Sets the bone already removed, mm^3 of reference density; counting continues from there.
  void count_removed_from(double removed_mm3) { removed_mm3_ = removed_mm3; }

  const Volume& volume() const { return *volume_; }
  /// Returns the bone for a session that continues with it.
  const std::shared_ptr<Volume>& shared_volume() const { return volume_; }
  const HapticAlgorithm& algorithm() const { return *algorithm_; }
  const MillingSetup& setup() const { return setup_; }
  const BoneDensities& densities() const { return densities_; }

 private:
  TickRecord tick_of(Device& device, const TickInput& input);
  double usable_tick_s(double dt_s) const noexcept;
  TickRecord begin_record(Device& device, const TickInput& input);
  void work(Device& device, TickRecord& record);
  void pause(Device& device, TickRecord& record);
  void begin_at(const Pose& X_WT) noexcept;
  void forget_contacts(const std::optional<Pose>& X_WT) noexcept;
  struct SafeStep {
    HapticStep step;
    SafeWrench sent;
    // Part of the sent torque that is due to cutting.
    Vec3 cutting_torque_W_Nmm = Vec3::Zero();
    ShaftDrag shaft_drag = {};
  };
  SafeStep step_safely(const Pose& X_WD, double dt_s, bool spindle_on, bool is_driven) noexcept;
  bool is_free(const Pose& X_WD) const noexcept;
  void mill(const HapticStep& step, const ShaftDrag& shaft_drag, TickRecord& record) noexcept;
  double vibrating_N(const Vec3& burr_force_W_N) const noexcept;

  // Held by pointer because the algorithm keeps its address.
  std::shared_ptr<Volume> volume_;
  MillingSetup setup_;
  BoneDensities densities_;
  std::unique_ptr<HapticAlgorithm> algorithm_;
  MillingSettings milling_;
  BurrMill mill_;
  CuttingReaction reaction_;
  NoGoWatch no_go_;
  Spindle spindle_;
  // Load torque of the last tick, and the recent ratio of the removed to the paid rate.
  double load_Nmm_ = 0;
  double cutting_share_ = 0;
  Vibration vibration_;
  ContactTransient transient_;
  WrenchGuard guard_;
  std::vector<Vec3> points_inside_T_;
  double removed_mm3_ = 0;
  VolumeChange last_change_;
  std::optional<Vec3> intersection_W_;
  // Empty before the first tick.
  std::optional<Pose> last_X_WT_;
  bool fade_out_requested_ = false;
  bool place_requested_ = false;
  bool hold_back_requested_ = false;
};

/// Runs the session along the trajectory, one tick per row, and calls `record` after each. A tick lasts for
/// the time since the previous row; the first as long as the second, or 1 ms if it is the only one.
void replay(MillingSession& session, const std::vector<TrajectoryPoint>& trajectory,
            const std::function<void(const TickRecord&)>& record);

}  // namespace osteomill
