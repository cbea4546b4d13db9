// Replaces libHD in tests without a device. Has the functions that osteomill uses, under the vendor's names.

#include "tests/support/hd_stand_in.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string_view>
#include <thread>

#include "tests/support/stand_in.h"

namespace {

HdStandIn g_state;
std::thread g_scheduler;
std::atomic<bool> g_runs{false};
unsigned (*g_callback)(void*) = nullptr;
void* g_data = nullptr;
std::atomic<unsigned> g_error = 0;
double g_most_N = 0;

void run() {
  auto next = std::chrono::steady_clock::now();
  while (g_runs) {
    if (!g_state.hangs) g_callback(g_data);
    std::this_thread::sleep_until(next += std::chrono::milliseconds(1));
  }
}

}  // namespace

extern "C" {

struct HDErrorInfo {
  unsigned code;
  int internal_code;
  unsigned device;
};

HdStandIn* hd_stand_in() {
  return &g_state;
}

unsigned hdInitDevice(const char* name) {
  const std::string_view wanted = name == nullptr ? "" : name;
  if (!g_state.is_there || !(wanted.empty() || wanted == "Left")) {
    g_error = 0x0300;
    return 0xffffffff;
  }
  g_state.is_open = true;
  return 7;
}
void hdDisableDevice(unsigned) {
  g_state.is_open = false;
  osteomill::testing_support::log_of_stand_in("closed, frames", g_state.frames, "most", g_most_N, "last",
                                              g_state.force[0], g_state.force[1], g_state.force[2]);
}
void hdBeginFrame(unsigned) {
  if (!g_state.is_held) g_state.transform[12] = osteomill::testing_support::swept_mm();
}
void hdEndFrame(unsigned) {
  g_error = g_state.error.load();
  ++g_state.frames;
  g_most_N = std::max(g_most_N, std::hypot(g_state.force[0], g_state.force[1], g_state.force[2]));
}
void hdGetDoublev(unsigned parameter, double* values) {
  if (parameter == 0x2052) std::copy(g_state.transform.begin(), g_state.transform.end(), values);
  if (parameter == 0x2603) *values = 3.3;
  if (parameter == 0x2622) *values = 188;
}
void hdSetDoublev(unsigned parameter, const double* values) {
  if (parameter == 0x2700) std::copy_n(values, 3, g_state.force.begin());
  if (parameter == 0x2701) std::copy_n(values, 3, g_state.torque.begin());
}
void hdGetIntegerv(unsigned parameter, int* values) {
  if (parameter == 0x2000) *values = g_state.buttons;
  if (parameter == 0x2553) *values = 6;
  if (parameter == 0x2555) *values = 1 | 4;
  if (parameter == 0x2554) *values = g_state.output_dof;
}
const char* hdGetString(unsigned parameter) {
  return parameter == 0x2501 ? "Touch" : parameter == 0x2504 ? "0815" : nullptr;
}
void hdEnable(unsigned what) {
  if (what == 0x4000) g_state.has_force = true;
}
unsigned hdCheckCalibration() {
  return g_state.calibration;
}
void hdUpdateCalibration(unsigned style) {
  g_state.updated_style = style;
  g_state.calibration = 0x5000;
}
HDErrorInfo hdGetError() {
  const unsigned code = g_error.exchange(0);
  return {code, 0, 7};
}
const char* hdGetErrorString(unsigned) {
  return "the stand-in fails";
}
unsigned long hdScheduleAsynchronous(unsigned (*callback)(void*), void* data, unsigned short) {
  g_callback = callback;
  g_data = data;
  return 1;
}
void hdUnschedule(unsigned long) {}
void hdStartScheduler() {
  g_runs = true;
  g_scheduler = std::thread(run);
}
void hdStopScheduler() {
  g_runs = false;
  if (g_scheduler.joinable()) g_scheduler.join();
}

}  // extern "C"
