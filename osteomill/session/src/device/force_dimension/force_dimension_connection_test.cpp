#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <numbers>
#include <string>
#include <utility>

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/session/connected_device.h"
#include "osteomill/session/hardware.h"

#include "tests/support/dhd_stand_in.h"
#include "tests/wait.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;

class ForceDimension : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("OSTEOMILL_DHD_LIBRARY", OSTEOMILL_DHD_STAND_IN, 1);
    library_ = dlopen(OSTEOMILL_DHD_STAND_IN, RTLD_NOW);
    ASSERT_NE(library_, nullptr) << dlerror();
    device_ = reinterpret_cast<DhdStandIn* (*)()>(dlsym(library_, "dhd_stand_in"))();
    *device_ = {};
    device_->is_held = true;
  }
  void TearDown() override {
    dlclose(library_);
    unsetenv("OSTEOMILL_DHD_LIBRARY");
  }
  std::string refusal(const std::string& address = "") {
    try {
      open_force_dimension(address);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  DhdStandIn* device_ = nullptr;
  void* library_ = nullptr;
};

TEST_F(ForceDimension, SaysWhatItCan) {
  const auto connection = open_force_dimension("");
  const DeviceCapabilities& can = connection->capabilities();
  EXPECT_EQ(can.name, "Force Dimension sigma.7 4711");
  EXPECT_EQ(can.sensed, 6);
  EXPECT_EQ(can.driven, 6);
  EXPECT_EQ(can.limits.force_N, 20);
  EXPECT_EQ(device_->max_force_N, 20);
  EXPECT_EQ(device_->max_torque_Nm, 0.4);
  // The maximum, 255 steps of 125 us; can be set in expert mode only.
  EXPECT_EQ(device_->watchdog, 255);
  EXPECT_FALSE(device_->is_expert);
  EXPECT_NEAR(can.watchdog_s, 0.032, 1e-3);
  EXPECT_TRUE(device_->emulates_button);
  // B: x towards the operator, y to the right, z up.
  EXPECT_TRUE((can.R_VB * Vec3::UnitX()).isApprox(Vec3::UnitZ()));
  EXPECT_TRUE((can.R_VB * Vec3::UnitY()).isApprox(Vec3::UnitX()));
}

TEST_F(ForceDimension, ReportsNoWatchdogWhenItHasNone) {
  device_->max_watchdog = 0;
  EXPECT_EQ(open_force_dimension("")->capabilities().watchdog_s, 0);
}

TEST_F(ForceDimension, SetsForceLimitsForEveryModel) {
  for (const int type : {33, 34, 35, 36, 37, 60, 63, 104, 105, 108, 109, 131, 132, 203, 206}) {
    device_->system_type = type;
    open_force_dimension("");
    EXPECT_GE(device_->max_force_N, 8) << type;
    EXPECT_EQ(device_->max_torque_Nm > 0, type == 63 || (type >= 104 && type <= 109)) << type;
  }
}

// Force is switched on after calibration and again after a watchdog timeout, but not if the operator or the
// brakes switched it off.
TEST_F(ForceDimension, IsDrivenWhenCalibratedAndForceIsOn) {
  enum { kReset = 3, kForce = 5, kBrake = 6, kCause = 14 };
  device_->status[kReset] = 1;
  const auto connection = open_force_dimension("");
  DeviceInput input;
  const auto why_not = [&] {
    for (const auto end = std::chrono::steady_clock::now() + 25ms; std::chrono::steady_clock::now() < end;)
      EXPECT_EQ(connection->read(input), ConnectionStatus::fresh);
    return std::string(input.not_driven == nullptr ? "" : input.not_driven);
  };
  EXPECT_EQ(why_not().substr(0, 17), "is not calibrated");
  EXPECT_EQ(device_->status[kForce], 0);
  device_->status[kReset] = 0;
  EXPECT_EQ(why_not(), "");
  EXPECT_EQ(device_->status[kForce], 1);
  for (const auto& [cause, said] : {std::pair(1, "by its button"), std::pair(2, "has braked"),
                                    std::pair(0, "switch it on"), std::pair(6, "dead man")}) {
    device_->status[kForce] = 0;
    device_->status[kBrake] = 1;
    device_->status[kCause] = cause;
    EXPECT_NE(why_not().find(said), std::string::npos) << input.not_driven;
    EXPECT_EQ(device_->status[kForce], 0);
    // The operator switches it on.
    device_->status[kForce] = 1;
    device_->status[kBrake] = 0;
    EXPECT_EQ(why_not(), "");
  }
  // A watchdog timeout is reported; force is switched on again only after zero was sent.
  connection->write({{0, 0, 5}, Vec3::Zero()});
  device_->status[kForce] = 0;
  device_->status[kCause] = 3;
  for (int n = 0; n < 2; ++n) {
    EXPECT_EQ(why_not(), "has its force off because it received no wrench in time");
    EXPECT_EQ(device_->status[kForce], 0);
  }
  connection->write({});
  EXPECT_EQ(why_not(), "");
  EXPECT_EQ(device_->status[kForce], 1);
}

TEST_F(ForceDimension, ReturnsNoPoseForAnInvalidRotation) {
  ConnectedDevice device([] { return open_force_dimension(""); });
  for (const double all : {0.0, 1.0}) {
    std::fill_n(&device_->frame[0][0], 9, all);
    for (int n = 0; n < 3; ++n) device.exchange();
    EXPECT_EQ(device.report().state, DeviceReport::State::not_finite) << all;
    EXPECT_FALSE(is_finite(device.read_pose()));
  }
}

TEST_F(ForceDimension, ReportsAndAbandonsALibraryCallThatHangs) {
  DhdHang& hang = *reinterpret_cast<DhdHang* (*)()>(dlsym(library_, "dhd_hang"))();
  constexpr const char* kFunction = "dhdSetForceAndTorqueAndGripperForce";
  const int closed = hang.closed;
  {
    ConnectedDevice device([] { return open_force_dimension(""); });
    device.start();
    hang.in = kFunction;
    EXPECT_TRUE(testing_support::becomes_true_in_time(
        [&] { return device.report().state == DeviceReport::State::hangs; }));
    EXPECT_EQ(device.report().reason, kFunction);
    EXPECT_NE(device.close().find(std::string(kFunction) + " does not return"), std::string::npos);
    EXPECT_EQ(device.close(), "");
  }
  // The detached thread ends once the call returns.
  hang.in = nullptr;
  EXPECT_TRUE(testing_support::becomes_true_in_time([&] { return hang.closed > closed; }));
}

TEST_F(ForceDimension, OpeningKeepsForceOffAfterButtonOrBrake) {
  enum { kForce = 5, kBrake = 6, kCause = 14 };
  for (const auto& [cause, is_on] : {std::pair(1, 0), std::pair(2, 0), std::pair(0, 1), std::pair(4, 1)}) {
    device_->status[kForce] = 0;
    device_->status[kBrake] = 1;
    device_->status[kCause] = cause;
    const auto connection = open_force_dimension("");
    DeviceInput input;
    EXPECT_EQ(connection->read(input), ConnectionStatus::fresh);
    EXPECT_EQ(device_->status[kForce], is_on) << cause;
    EXPECT_EQ(input.not_driven == nullptr, is_on == 1) << cause;
  }
}

// Reads from the vendor's real library, with a real or simulated device; sends nothing.
TEST(ForceDimensionLibrary, ReadsPosesThroughTheVendorLibrary) {
  const char* const library = std::getenv("OSTEOMILL_LIBDHD");
  if (library == nullptr) GTEST_SKIP() << "OSTEOMILL_LIBDHD does not name the vendor's library";
  setenv("OSTEOMILL_DHD_LIBRARY", library, 1);
  const auto connection = open_force_dimension("");
  unsetenv("OSTEOMILL_DHD_LIBRARY");
  DeviceInput input;
  for (int n = 0; n < 500; ++n) {
    ASSERT_EQ(connection->read(input), ConnectionStatus::fresh);
    ASSERT_EQ(connection->write({}), ConnectionStatus::fresh);
  }
  EXPECT_NEAR(input.X_BH.orientation.norm(), 1, 1e-6);
  EXPECT_LT(input.X_BH.position_mm.norm(), 500);
}

TEST_F(ForceDimension, ConvertsMetresToMillimetresAndFrameToRotation) {
  const auto connection = open_force_dimension("");
  device_->position_m = {0.01, -0.02, 0.03};
  device_->buttons = 5;
  // A quarter turn about z: x of the handle points along y.
  const double quarter[3][3] = {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  std::copy_n(&quarter[0][0], 9, &device_->frame[0][0]);
  DeviceInput input;
  ASSERT_EQ(connection->read(input), ConnectionStatus::fresh);
  EXPECT_TRUE(input.X_BH.position_mm.isApprox(Vec3(10, -20, 30)));
  EXPECT_EQ(input.buttons, 5u);
  EXPECT_NEAR((rotation_vector(input.X_BH.orientation) - Vec3(0, 0, std::numbers::pi / 2)).norm(), 0, 1e-12);
}

TEST_F(ForceDimension, SendsForceInNewtonsAndTorqueInNewtonMetres) {
  const auto connection = open_force_dimension("");
  EXPECT_EQ(connection->write({{1, 2, 3}, {40, 50, 60}}), ConnectionStatus::fresh);
  const std::array<double, 7> sent{1, 2, 3, 0.04, 0.05, 0.06, 0};
  EXPECT_EQ(device_->sent, sent);
}

TEST_F(ForceDimension, NeitherSensesNorDrivesAMissingWrist) {
  device_->has_wrist = device_->has_active_wrist = false;
  const auto connection = open_force_dimension("");
  EXPECT_EQ(connection->capabilities().sensed, 3);
  EXPECT_EQ(connection->capabilities().driven, 3);
  connection->write({{1, 2, 3}, {40, 50, 60}});
  EXPECT_EQ(device_->sent[3], 0);
  DeviceInput input;
  device_->frame[0][0] = 0;
  ASSERT_EQ(connection->read(input), ConnectionStatus::fresh);
  EXPECT_TRUE(input.X_BH.orientation.isApprox(Quat::Identity()));
}

TEST_F(ForceDimension, IsSilentWithoutANewPoseAndLostOnFailure) {
  const auto connection = open_force_dimension("");
  DeviceInput input;
  device_->pose_result = 1;
  EXPECT_EQ(connection->read(input), ConnectionStatus::silent);
  device_->pose_result = 0;
  EXPECT_EQ(connection->read(input), ConnectionStatus::fresh);
  device_->fails_in = "dhdGetPositionAndOrientationFrame";
  EXPECT_EQ(connection->read(input), ConnectionStatus::lost);
  device_->fails_in = "dhdSetForceAndTorqueAndGripperForce";
  EXPECT_EQ(connection->write({}), ConnectionStatus::lost);
}

TEST_F(ForceDimension, ClosingSendsZeroAndStops) {
  auto connection = open_force_dimension("");
  connection->write({{1, 2, 3}, Vec3::Zero()});
  connection.reset();
  EXPECT_EQ(device_->sent, (std::array<double, 7>{}));
  EXPECT_TRUE(device_->is_stopped);
  EXPECT_EQ(device_->opened, -1);
}

TEST_F(ForceDimension, WhyThereIsNoneIsSaid) {
  EXPECT_EQ(refusal("left"), "dhd: 'left' is not the number of a device");
  EXPECT_EQ(refusal("1"), "dhd: there is no device 1, the last of 1 is 0");
  device_->fails_in = "dhdOpenID";
  EXPECT_EQ(refusal(), "dhd: the stand-in fails");
  device_->fails_in = "dhdEnableForce";
  EXPECT_EQ(refusal(), "dhd: the stand-in fails");
  EXPECT_EQ(device_->opened, -1);
  EXPECT_TRUE(hardware_named("dhd")->find("").is_present);
  EXPECT_EQ(hardware_named("dhd")->find("").text, "a device connected");
  device_->devices = 0;
  EXPECT_EQ(hardware_named("dhd")->find("").text, "dhd: no device is connected");
}

TEST_F(ForceDimension, ReportsAMissingOrWrongLibrary) {
  unsetenv("OSTEOMILL_DHD_LIBRARY");
  EXPECT_EQ(
      refusal(),
      "dhd: libdhd.so.3 of the vendor's software is not installed; OSTEOMILL_DHD_LIBRARY can name its path");
  setenv("OSTEOMILL_DHD_LIBRARY", "/nowhere/libdhd.so", 1);
  EXPECT_NE(refusal().find("/nowhere/libdhd.so"), std::string::npos);
  setenv("OSTEOMILL_DHD_LIBRARY", "libm.so.6", 1);
  EXPECT_EQ(refusal(), "dhd: libm.so.6 has no dhdGetDeviceCount");
}

}  // namespace
}  // namespace osteomill
