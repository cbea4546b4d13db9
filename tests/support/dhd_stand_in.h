#pragma once

#include <array>
#include <atomic>
#include <string>

/// State of the stand-in for libdhd (names and numbers as in dhdc.h, SDK 3.17.5): its answers, and the last
/// commands it received. A test gets it with dlsym("dhd_stand_in").
struct DhdStandIn {
  int devices = 1;
  bool has_wrist = true;
  bool has_active_wrist = true;
  int system_type = 104;
  /// Name of the function that returns an error.
  std::string fails_in;
  /// 0, or 1 if the pose is not new.
  int pose_result = 0;
  /// If false, the handle sweeps.
  bool is_held = false;
  std::array<double, 3> position_m{};
  double frame[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  unsigned buttons = 0;
  /// The result of dhdGetStatus (dhdc.h, DHD_STATUS_...); force can be enabled if [3], RESET, is 0.
  std::array<int, 17> status{1, 1, 1, 0, 1, 0, 1};
  bool has_gripper = true;
  /// 0 if the device has no watchdog.
  unsigned char max_watchdog = 255;

  int opened = -1;
  bool is_stopped = false;
  bool is_expert = false;
  bool emulates_button = false;
  int watchdog = 0;
  double max_force_N = 0;
  double max_torque_Nm = 0;
  /// Force (N), torque (N m), gripper force (N).
  std::array<double, 7> sent{};
  int times_sent = 0;
};

/// Name of the function that hangs as long as it is set here, and the number of closed devices. A test gets
/// it with dlsym("dhd_hang"). Thread-safe.
struct DhdHang {
  std::atomic<const char*> in{nullptr};
  std::atomic<int> closed{0};
};
