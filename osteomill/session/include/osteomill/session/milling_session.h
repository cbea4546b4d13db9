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

/// Returns how often a second the force goes round: the spindle's turns up to 100 a second, and from there as
/// many octaves higher as fit below 250 Hz, which hands feel best and a device at 1 kHz can still render. It
/// rises with the speed, everywhere.
double vibration_hz(double spindle_speed_rpm);

/// A force that goes round the shaft, as long as the burr cuts. Safe in the haptic tick.
class Vibration {
 public:
  explicit Vibration(const VibrationSettings& settings) : settings_(settings) {}

  /// Returns the force in W, `dt_s` after the last one, for a burr that cuts with `cutting_N` at the
  /// spindle's true speed.
  Vec3 force_N(const Pose& X_WT, double cutting_N, double spindle_rpm, double dt_s) noexcept;

 private:
  VibrationSettings settings_;
  double turns_ = 0;
};

/// The state that a session hands over to the one that resumes from it: the pose of its simulated tool, which
/// is outside the bone, the wrench that the hand feels, and whether it was held back (WrenchGuard). There is
/// no tool's pose if the next session is to begin at the device, which may have sunk into the bone.
struct SessionHandover {
  std::optional<Pose> X_WT;
  Wrench sent;
  bool held_back = true;
  double spindle_rpm = 0;
};

/// The time of a tick, and what is asked of it.
struct TickInput {
  /// Its beginning, which is only recorded, and its length: the time since the tick before, and until the
  /// next. A length that is not a positive number counts as MillingSetup::tick_s.
  double time_s = 0;
  double dt_s = 1e-3;
  /// The time by which the tick before is longer ago, because ticks were missed.
  double late_s = 0;
  /// Whether the spindle turns; if not given, the device says so (Device::is_spindle_requested).
  std::optional<bool> spindle_on = {};
  /// Sends zero and computes nothing; contacts are kept.
  bool paused = false;
};

/// One tool, one bone and one algorithm, tick by tick: read the pose, compute, send the wrench, remove bone.
/// The wrench goes out before bone is removed, so that milling cannot delay the hand.
class MillingSession {
 public:
  /// Makes a session ready to tick; takes as long as the algorithm's preparation. A session that has milled
  /// the same bone takes no further tick while this one lives, because algorithms follow only the milling of
  /// their own session. Throws std::invalid_argument if a setting is out of range, the tool cannot work
  /// (`require_workable`), or structures of the bone have a guard that the algorithm does not hold.
  MillingSession(std::shared_ptr<Volume> bone, const BoneDensities& densities, const MillingSetup& setup);

  /// Runs one haptic tick, all of it: reads the device's pose, computes and sends the wrench, removes as much
  /// bone as the force that was sent pays for, and tells the device that the tick is done. If the wrench or
  /// the device's pose is not finite, what is sent falls to zero as fast as the guard allows (20 N in 5 ms;
  /// at once with GuardSettings::for_simulation) and the record's fault gives the reason. Real-time safe: no
  /// allocation, lock, log or system call, and no exception except the device's own. After that one, zero was
  /// written to the device, and the hand is held back (WrenchGuard::hold_back).
  TickRecord tick(Device& device, const TickInput& input) OSTEOMILL_NONBLOCKING;

  /// Returns the guard between the algorithm and the hand. As safe as `tick`.
  WrenchGuard& guard() { return guard_; }

  /// Resumes where another session ended, whose wrench the hand feels. Call before the first tick; as safe
  /// as `tick`.
  void resume_from(const SessionHandover& before) noexcept;
  /// Returns the state from which another session resumes, after the last tick.
  SessionHandover handover() const {
    return {last_X_WT_, guard_.sent(), guard_.is_held_back(), spindle_.speed_rpm()};
  }
  /// Lets the next tick count as one that reaches no hand (Device::is_driven), as after a time without ticks.
  /// The call is as safe as `tick`.
  void hold_back() noexcept { hold_back_requested_ = true; }

  /// Brings the wrench down to zero slowly, from the next tick on, and keeps it there until the tool is
  /// placed. As safe as `tick`.
  void fade_out() noexcept { fade_out_requested_ = true; }
  /// Lets the algorithm begin again, in the next tick, at the pose that the device then has, whatever was
  /// touched before; the device is free of bone. As safe as `tick`.
  void place() noexcept { place_requested_ = true; }

  /// Returns what the last tick changed of the volume.
  const VolumeChange& last_change() const { return last_change_; }
  /// Returns HapticStep::intersection_W of the last tick, to be drawn.
  const std::optional<Vec3>& intersection_W() const { return intersection_W_; }
  /// Returns the bone removed since the start, in mm^3 of reference density.
  double removed_mm3() const { return removed_mm3_; }
  /// Goes on counting from what was removed of this bone before.
  void count_removed_from(double removed_mm3) { removed_mm3_ = removed_mm3; }

  const Volume& volume() const { return *volume_; }
  /// Returns the bone for a session that goes on with it.
  const std::shared_ptr<Volume>& shared_volume() const { return volume_; }
  const HapticAlgorithm& algorithm() const { return *algorithm_; }
  /// Returns the setup that it was made with.
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
    // The cutting's part of the torque sent.
    Vec3 cutting_torque_W_Nmm = Vec3::Zero();
    ShaftDrag shaft_drag = {};
  };
  SafeStep step_safely(const Pose& X_WD, double dt_s, bool spindle_on, bool is_driven) noexcept;
  bool is_free(const Pose& X_WD) const noexcept;
  void mill(const HapticStep& step, const ShaftDrag& shaft_drag, TickRecord& record) noexcept;
  double vibrating_N(const Vec3& burr_force_W_N) const noexcept;

  // Behind a pointer since the algorithm keeps its address.
  std::shared_ptr<Volume> volume_;
  MillingSetup setup_;
  BoneDensities densities_;
  std::unique_ptr<HapticAlgorithm> algorithm_;
  MillingSettings milling_;
  BurrMill mill_;
  CuttingReaction reaction_;
  NoGoWatch no_go_;
  Spindle spindle_;
  // By which the tick before held the spindle back, and how much of the paid rate was removed lately.
  double load_Nmm_ = 0;
  double cutting_share_ = 0;
  Vibration vibration_;
  ContactTransient transient_;
  WrenchGuard guard_;
  std::vector<Vec3> points_inside_T_;
  double removed_mm3_ = 0;
  VolumeChange last_change_;
  std::optional<Vec3> intersection_W_;
  // Nothing before the first tick.
  std::optional<Pose> last_X_WT_;
  bool fade_out_requested_ = false;
  bool place_requested_ = false;
  bool hold_back_requested_ = false;
};

/// Runs the session along the trajectory, a tick a row, each as long as the time since the row before (the
/// first as long as the second, or 1 ms if it is the only one); calls `record` after each tick.
void replay(MillingSession& session, const std::vector<TrajectoryPoint>& trajectory,
            const std::function<void(const TickRecord&)>& record);

}  // namespace osteomill
