// Replaces libdhd in tests without a device. Has the functions that osteomill uses, under the vendor's names.

#include "tests/support/dhd_stand_in.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string_view>
#include <thread>

#include "tests/support/stand_in.h"

namespace {

DhdStandIn g_state;
double g_most_N = 0;

DhdHang g_hang;

// The function named in the environment hangs after a second, like a broken cable.
bool hangs_in(std::string_view function) {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  static const char* const named = std::getenv("OSTEOMILL_STAND_IN_HANGS_IN");
  const char* const in = g_hang.in;
  return (in != nullptr && function == in) ||
         (named != nullptr && function == named && Clock::now() - start > std::chrono::seconds(1));
}

int result_of(std::string_view function) {
  while (hangs_in(function)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return g_state.fails_in == function ? -1 : 0;
}

}  // namespace

extern "C" {

DhdStandIn* dhd_stand_in() {
  return &g_state;
}

DhdHang* dhd_hang() {
  return &g_hang;
}

int dhdGetDeviceCount() {
  return g_state.devices;
}
int dhdOpenID(char id) {
  if (result_of("dhdOpenID") < 0) return -1;
  g_state.opened = id;
  g_state.is_stopped = false;
  return id;
}
int dhdClose(char) {
  g_state.opened = -1;
  osteomill::testing_support::log_of_stand_in("closed, sent", g_state.times_sent, "most", g_most_N, "last",
                                              g_state.sent[0], g_state.sent[1], g_state.sent[2]);
  ++g_hang.closed;
  return 0;
}
int dhdStop(char) {
  g_state.is_stopped = true;
  return 0;
}
const char* dhdErrorGetLastStr() {
  return "the stand-in fails";
}
const char* dhdGetSystemName(char) {
  return "sigma.7";
}
int dhdGetSystemType(char) {
  return g_state.system_type;
}
int dhdGetSerialNumber(unsigned short* number, char) {
  *number = 4711;
  return 0;
}
bool dhdHasWrist(char) {
  return g_state.has_wrist;
}
bool dhdHasActiveWrist(char) {
  return g_state.has_active_wrist;
}
bool dhdHasGripper(char) {
  return g_state.has_gripper;
}
int dhdEmulateButton(unsigned char on, char) {
  g_state.emulates_button = on != 0;
  return 0;
}
int dhdEnableExpertMode() {
  g_state.is_expert = true;
  return 0;
}
int dhdDisableExpertMode() {
  g_state.is_expert = false;
  return 0;
}
int dhdSetWatchdog(unsigned char value, char) {
  if (!g_state.is_expert || g_state.max_watchdog == 0) return -1;
  g_state.watchdog = std::min(value, g_state.max_watchdog);
  return 0;
}
int dhdGetWatchdog(unsigned char* value, char) {
  if (!g_state.is_expert || g_state.max_watchdog == 0) return -1;
  *value = static_cast<unsigned char>(g_state.watchdog);
  return 0;
}
int dhdGetStatus(int* status, char) {
  std::copy(g_state.status.begin(), g_state.status.end(), status);
  return result_of("dhdGetStatus");
}
int dhdSetBrakes(int on, char) {
  g_state.status[6] = on;
  return 0;
}
// Behaves like the vendor's library with its simulated device.
int dhdEnableForce(unsigned char on, char) {
  if (g_state.status[3] == 0) {
    g_state.status[5] = on;
    g_state.status[6] = 1 - on;
  }
  return result_of("dhdEnableForce");
}
int dhdSetMaxTorque(double torque_Nm, char) {
  g_state.max_torque_Nm = torque_Nm;
  return 0;
}
int dhdSetMaxForce(double force_N, char) {
  g_state.max_force_N = force_N;
  return 0;
}
int dhdGetPositionAndOrientationFrame(double* x, double* y, double* z, double frame[3][3], char) {
  const auto& p = g_state.position_m;
  *x = g_state.is_held ? p[0] : 1e-3 * osteomill::testing_support::swept_mm();
  *y = p[1];
  *z = p[2];
  std::copy_n(&g_state.frame[0][0], 9, &frame[0][0]);
  const int failed = result_of("dhdGetPositionAndOrientationFrame");
  return failed < 0 ? failed : g_state.pose_result;
}
unsigned dhdGetButtonMask(char) {
  return g_state.buttons;
}
int dhdSetForceAndTorqueAndGripperForce(double fx, double fy, double fz, double tx, double ty, double tz,
                                        double gripper, char) {
  g_state.sent = {fx, fy, fz, tx, ty, tz, gripper};
  ++g_state.times_sent;
  g_most_N = std::max(g_most_N, std::hypot(fx, fy, fz));
  return result_of("dhdSetForceAndTorqueAndGripperForce");
}

}  // extern "C"
