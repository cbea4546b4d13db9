#pragma once

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// The vibration that a cutting burr gives the hand (in the paper; its force is in earlier work, so this one
/// is this project's own).
struct VibrationSettings {
  bool on = false;
  /// Its amplitude as a share of the force with which the burr presses, and the most it may be.
  double force_share = 0.08;
  double max_N = 0.3;
};

/// How often a second the force goes round: the spindle's turns, divided by the least whole number that
/// brings them to at most 250 Hz, which hands feel best and a device at 1 kHz can still render.
double vibration_hz(double spindle_speed_rpm);

/// A force that goes round the shaft, as long as the burr cuts. Safe in the haptic tick.
class Vibration {
 public:
  Vibration(const VibrationSettings& settings, double spindle_speed_rpm)
      : settings_(settings), hz_(vibration_hz(spindle_speed_rpm)) {}

  /// In W, `dt_s` after the last one.
  Vec3 force_N(const Pose& X_WT, double burr_force_N, double dt_s);

 private:
  VibrationSettings settings_;
  double hz_;
  double turns_ = 0;
};

}  // namespace osteomill
