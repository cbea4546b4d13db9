#pragma once

#include <array>
#include <atomic>
#include <string>

/// Holds the answers of the stand-in for libdhd (names and numbers of dhdc.h, SDK 3.17.5), and its last
/// commands. A test has it by dlsym("dhd_stand_in").
struct DhdStandIn {
  int devices = 1;
  bool has_wrist = true;
  bool has_active_wrist = true;
  int system_type = 104;
  /// Name of the function that fails.
  std::string fails_in;
  /// 0, or 1 if the pose is no new one.
  int pose_result = 0;
  /// The handle sweeps if these are not set.
  bool is_held = false;
  std::array<double, 3> position_m{};
  double frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  unsigned buttons = 0;
  /// The result of dhdGetStatus (dhdc.h, DHD_STATUS_...); force can be enabled if [3], RESET, is 0.
  std::array<int, 17> status{1, 1, 1, 0, 1, 0, 1};
  bool has_gripper = true;
  /// If it is 0 the device has none.
  unsigned char max_watchdog = 255;

  int opened = -1;
  bool is_stopped = false;
  bool is_expert = false;
  bool emulates_button = false;
  int watchdog = 0;
  double max_force_N = 0;
  double max_torque_Nm = 0;
  /// Force (N), torque (N m), force of the gripper (N).
  std::array<double, 7> sent{};
  int times_sent = 0;
};

/// The function that does not return, for as long as it is named here, and how often a device was closed. A
/// test has it by dlsym("dhd_hang"); any thread.
struct DhdHang {
  std::atomic<const char*> in{nullptr};
  std::atomic<int> closed{0};
};
