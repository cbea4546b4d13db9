#include <cmath>

#include <gtest/gtest.h>

#include "osteomill/session/connected_device.h"

#include "tests/count_allocations.h"
#include "tests/scripted_device.h"

namespace osteomill {
namespace {

using testing_support::allocations_of_this_thread;

TEST(DeviceAllocation, CallsOfTheHapticThreadDoNotAllocate) {
  testing_support::ScriptedDevice hardware;
  ConnectedDevice device(hardware.way(), hardware.clock());
  long allocations = 0;
  for (int n = 0; n < 3000; ++n) {
    hardware.now_s += 1e-3;
    hardware.input.X_BH.position_mm.x() = std::sin(0.1 * n);
    // Meanwhile the device is silent, clutched, turned, moved, lost and reopened.
    hardware.silent = n % 100 > 80;
    hardware.input.buttons = n % 150 > 130 ? ConnectedDevice::kClutchButton : 1;
    hardware.gone = n > 1000 && n < 1500;
    if (n % 50 == 0) device.set_view(quaternion_from_rotation_vector({0, 0.01 * n, 0}));
    device.exchange();
    const long before = allocations_of_this_thread();
    if (n % 70 == 0) device.put_at({{1, 2, 3}, Quat::Identity()});
    const Pose X_WD = device.read_pose();
    device.write_wrench({{0, 0, device.is_spindle_requested() ? 3.0 : 1.0}, {0, 5, 0}});
    device.tick_done(X_WD, 1e-3);
    if (n == 2900) device.disengage();
    allocations += allocations_of_this_thread() - before;
  }
  EXPECT_EQ(allocations, 0);
  EXPECT_EQ(device.report().reopened, 1u);
}

}  // namespace
}  // namespace osteomill
