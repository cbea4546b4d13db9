#pragma once

#include <array>
#include <atomic>

/// Holds the answers of the stand-in for libHD (names and numbers of hd.h and hdDefines.h, 3.0), and its last
/// commands; its scheduler calls 1000 times a second. A test has it by dlsym("hd_stand_in"), and changes
/// plain members only while no scheduler runs.
struct HdStandIn {
  bool is_there = true;
  int output_dof = 3;
  /// The handle sweeps if this is not set.
  bool is_held = false;
  /// Columns; mm.
  std::array<double, 16> transform{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  int buttons = 0;

  /// Said by hdCheckCalibration: 0x5000 calibrated, 0x5001 needs an update, 0x5002 an operator (hdDefines.h).
  std::atomic<unsigned> calibration{0x5000};
  std::atomic<unsigned> updated_style{0};
  /// Said by hdGetError after each frame.
  std::atomic<unsigned> error{0};
  /// The scheduler runs but no longer calls.
  std::atomic<bool> hangs{false};

  std::atomic<bool> is_open{false};
  std::atomic<bool> has_force{false};
  /// The last values of hdSetDoublev.
  std::array<std::atomic<double>, 3> force{};
  std::array<std::atomic<double>, 3> torque{};
  std::atomic<int> frames{0};
};
