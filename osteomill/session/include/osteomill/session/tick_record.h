#pragma once

#include <cstdint>
#include <limits>

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/milling/label_tally.h"

namespace osteomill {

/// All that is known of one tick: what recordings hold and reports are made from.
struct TickRecord {
  /// The value of a number that recordings of earlier programs do not have.
  static constexpr double kNotRecorded = -1;

  double time_s = 0;
  /// The length that the tick was taken to have, and whether the spindle turned. With the tool's pose and the
  /// burr's force that is all that milling depends on.
  double dt_s = 0;
  bool spindle_on = false;
  /// The session's other inputs beside the device's pose. The share of the force that the hand had so far
  /// (Device::delivered_fraction); whether what was sent reached a hand (Device::is_driven); whether the tick
  /// is one of a pause; whether from this tick on nothing is felt until the tool is placed; whether before
  /// this tick the tool was placed where the device is, and its contacts were forgotten.
  double delivered_fraction = 1;
  bool driven = true;
  bool paused = false;
  bool fade_out = false;
  bool placed = false;
  /// The number of its session, if several follow each other on a bone.
  std::uint32_t session = 0;
  /// The device's pose as read, and the simulated tool's.
  Pose X_WD;
  Pose X_WT;
  /// The wrench that was sent to the device (safe), in W about the burr's centre.
  Wrench wrench;
  WrenchFault fault = WrenchFault::none;
  /// The part of its torque that cutting adds (CuttingReaction).
  Vec3 cutting_torque_W_Nmm = Vec3::Zero();
  /// The energy given to the hand less what it gave, up to this tick's pose (PassivityObserver), in N mm.
  double energy_given_Nmm = 0;
  int contacts = 0;
  /// The bricks that were not up to date (HapticStep::pending_bricks).
  int pending_bricks = 0;
  /// The force with which the burr pressed on the bone, in W.
  Vec3 burr_force_W_N = Vec3::Zero();
  /// The spindle's true speed, the power that went into what was removed, and the density of the bone before
  /// the burr relative to the reference (0 without contact, 1 with constant energy).
  double spindle_rpm = kNotRecorded;
  double cutting_power_W = kNotRecorded;
  double cut_density = kNotRecorded;
  /// The bone removed since the start, in mm^3 of reference density.
  double removed_mm3 = 0;
  /// The distance of the burr's surface from the nearest structure that it must not touch (Volume::no_go);
  /// not a number without structures.
  double no_go_distance_mm = std::numeric_limits<double>::quiet_NaN();
  /// The hash of the bone after the tick (Volume::change_hash).
  std::uint64_t bone_hash = 0;
  /// If the bone has labels: how much of which was taken in this tick, and which no-go ones were touched.
  LabelCuts label_cuts{};
  /// Time taken by the algorithm's step, and by milling with all that follows the volume.
  double compute_us = 0;
  double milling_us = 0;
  /// CPU time that the thread itself had for the whole tick, which no other program on the machine lengthens.
  /// 0 if it was not measured: asking for it is a system call, so only a loop whose ticks no hand waits for
  /// can ask, before and after them.
  double tick_cpu_us = 0;

  /// Returns how long the tick kept its loop busy: by the thread's own CPU time if it is known, else by the
  /// clock.
  double busy_us() const { return tick_cpu_us > 0 ? tick_cpu_us : compute_us + milling_us; }
};

}  // namespace osteomill
