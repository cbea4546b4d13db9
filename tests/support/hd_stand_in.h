#pragma once

#include <array>
#include <atomic>

/// State of the stand-in for libHD (names and numbers as in hd.h and hdDefines.h, 3.0): its answers, and the
/// last commands it received. Its scheduler runs at 1000 Hz. A test gets it with dlsym("hd_stand_in"), and
/// changes non-atomic members only while no scheduler runs.
struct HdStandIn {
  bool is_there = true;
  int output_dof = 3;
  /// If false, the handle sweeps.
  bool is_held = false;
  /// Column-major, mm.
  std::array<double, 16> transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  int buttons = 0;

  /// Result of hdCheckCalibration (hdDefines.h): 0x5000 calibrated, 0x5001 needs an update, 0x5002 needs
  /// manual input.
  std::atomic<unsigned> calibration{0x5000};
  std::atomic<unsigned> updated_style{0};
  /// Result of hdGetError after each frame.
  std::atomic<unsigned> error{0};
  /// If true, the scheduler runs but no longer calls back.
  std::atomic<bool> hangs{false};

  std::atomic<bool> is_open{false};
  std::atomic<bool> has_force{false};
  /// Last values of hdSetDoublev.
  std::array<std::atomic<double>, 3> force{};
  std::array<std::atomic<double>, 3> torque{};
  std::atomic<int> frames{0};
};
