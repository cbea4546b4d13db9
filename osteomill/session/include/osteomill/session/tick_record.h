#pragma once

#include <cstdint>
#include <limits>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/milling/label_tally.h"

namespace osteomill {

/// Data of one tick, stored in recordings and used for reports.
struct TickRecord {
  /// Value of fields that are missing in recordings of earlier versions.
  static constexpr double kNotRecorded = -1;

  double time_s = 0;
  /// Tick length used, and whether the spindle was on. Milling depends on these, the tool's pose, the
  /// burr's force and, with a handpiece, `spindle_rpm` only.
  double dt_s = 0;
  bool spindle_on = false;
  /// The session's other inputs besides the device's pose: the fraction of the force that reached the hand
  /// (Device::delivered_fraction); Device::is_driven; whether the session was paused; whether the wrench
  /// fades out from this tick on until the tool is placed; whether the tool was placed at the device before
  /// this tick, which discards its contacts.
  double delivered_fraction = 1;
  bool driven = true;
  bool paused = false;
  bool fade_out = false;
  bool placed = false;
  /// Index of the session, if several follow one another on a bone.
  std::uint32_t session = 0;
  /// The device's pose as read, and the simulated tool's pose.
  Pose X_WD;
  Pose X_WT;
  /// Wrench sent to the device (after the guard), in W about the burr's centre.
  Wrench wrench;
  WrenchFault fault = WrenchFault::none;
  /// Part of the sent torque that is due to cutting (CuttingReaction).
  Vec3 cutting_torque_W_Nmm = Vec3::Zero();
  /// Net energy given to the hand up to this tick's pose, N mm (PassivityObserver).
  double energy_given_Nmm = 0;
  int contacts = 0;
  /// Bricks not yet up to date (HapticStep::pending_bricks).
  int pending_bricks = 0;
  /// Force of the burr on the bone, in W.
  Vec3 burr_force_W_N = Vec3::Zero();
  /// Actual speed of the spindle, power spent on removal, and density of the bone in front of the burr
  /// relative to the reference (0 without contact, 1 at constant energy).
  double spindle_rpm = kNotRecorded;
  double cutting_power_W = kNotRecorded;
  double cut_density = kNotRecorded;
  /// Bone removed since the start, mm^3 of reference density.
  double removed_mm3 = 0;
  /// Distance from the burr's surface to the nearest no-go structure (Volume::no_go); NaN without structures.
  double no_go_distance_mm = std::numeric_limits<double>::quiet_NaN();
  /// Hash of the bone after the tick (Volume::change_hash).
  std::uint64_t bone_hash = 0;
  /// Bone removed per label, and no-go labels touched, in this tick; empty if the bone has no labels.
  LabelCuts label_cuts{};
  /// Time of the algorithm's step, and of milling including all updates that follow a change of the volume.
  double compute_us = 0;
  double milling_us = 0;
  /// CPU time of the thread for the whole tick, which is independent of other programs. 0 if not measured:
  /// reading it is a system call, so only loops that no hand waits for measure it.
  double tick_cpu_us = 0;

  /// Returns the time for which the tick kept its loop busy: the thread's CPU time if measured, otherwise
  /// wall-clock time.
  double busy_us() const { return tick_cpu_us > 0 ? tick_cpu_us : compute_us + milling_us; }
};

}  // namespace osteomill
