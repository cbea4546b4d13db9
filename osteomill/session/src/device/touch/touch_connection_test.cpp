#include <chrono>
#include <cstdlib>
#include <numbers>
#include <string>
#include <thread>

#include <dlfcn.h>
#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/session/hardware.h"

#include "tests/support/hd_stand_in.h"
#include "tests/wait.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;

class Touch : public ::testing::Test {
 protected:
  void SetUp() override {
    setenv("OSTEOMILL_HD_LIBRARY", OSTEOMILL_HD_STAND_IN, 1);
    library_ = dlopen(OSTEOMILL_HD_STAND_IN, RTLD_NOW);
    ASSERT_NE(library_, nullptr) << dlerror();
    device_ = reinterpret_cast<HdStandIn* (*)()>(dlsym(library_, "hd_stand_in"))();
    device_->is_held = true;
  }
  // Unloads the library, so that the next test starts with fresh state.
  void TearDown() override {
    connection_.reset();
    dlclose(library_);
    unsetenv("OSTEOMILL_HD_LIBRARY");
  }
  void open(const std::string& address = "") { connection_ = open_touch(address); }
  std::string refusal(const std::string& address = "") {
    try {
      open_touch(address);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }
  // Waits until a whole frame has run since the call.
  void await_frame() {
    const int before = device_->frames;
    EXPECT_TRUE(testing_support::becomes_true_in_time([&] { return device_->frames >= before + 2; }));
  }
  Vec3 force() const { return {device_->force[0], device_->force[1], device_->force[2]}; }
  Vec3 torque() const { return {device_->torque[0], device_->torque[1], device_->torque[2]}; }
  // Writes until the device has the wrench; on a busy machine it may lapse first.
  void write_until_it_is(const Wrench& wrench, const Vec3& force_wanted, const Vec3& torque_wanted) {
    for (int n = 0; n < 200 && !(force().isApprox(force_wanted) && torque().isApprox(torque_wanted)); ++n) {
      connection_->write(wrench);
      await_frame();
    }
    EXPECT_TRUE(force().isApprox(force_wanted)) << force();
    EXPECT_TRUE(torque().isApprox(torque_wanted)) << torque();
  }
  ConnectionStatus read_until_it_is(ConnectionStatus wanted, DeviceInput& input) {
    ConnectionStatus status = connection_->read(input);
    for (int n = 0; n < 1000 && status != wanted; ++n) status = connection_->read(input);
    return status;
  }

  HdStandIn* device_ = nullptr;
  std::unique_ptr<Connection> connection_;

 private:
  void* library_ = nullptr;
};

TEST_F(Touch, SaysWhatItCan) {
  open("Left");
  const DeviceCapabilities& can = connection_->capabilities();
  EXPECT_EQ(can.name, "3D Systems Touch 0815");
  EXPECT_EQ(can.sensed, 6);
  EXPECT_EQ(can.driven, 3);
  EXPECT_EQ(can.limits.force_N, 3.3);
  EXPECT_EQ(can.watchdog_s, 0);
}

TEST_F(Touch, ListingLeavesMotorsUnpowered) {
  EXPECT_EQ(hardware_named("hd")->find("").text, "3D Systems Touch 0815");
  EXPECT_FALSE(device_->has_force);
  EXPECT_EQ(device_->frames, 0);
  EXPECT_FALSE(device_->is_open);
}

TEST_F(Touch, GivesANonFinitePoseForAnInvalidRotation) {
  device_->transform.fill(0);
  open();
  DeviceInput input;
  read_until_it_is(ConnectionStatus::fresh, input);
  EXPECT_FALSE(is_finite(input.X_BH));
  EXPECT_TRUE(input.X_BH.position_mm.allFinite());
}

TEST_F(Touch, IsDrivenOnceItIsCalibrated) {
  device_->calibration = 0x5002;
  open();
  DeviceInput input;
  read_until_it_is(ConnectionStatus::fresh, input);
  EXPECT_EQ(std::string(input.not_driven).substr(0, 17), "is not calibrated");
  for (int n = 0; n < 5; ++n) {
    connection_->write({{1, 2, 3}, Vec3::Zero()});
    await_frame();
    EXPECT_EQ(force(), Vec3::Zero());
  }
  EXPECT_FALSE(device_->has_force);
  // The stylus is in the inkwell.
  device_->calibration = 0x5001;
  await_frame();
  EXPECT_EQ(device_->updated_style, 4u);
  await_frame();
  read_until_it_is(ConnectionStatus::fresh, input);
  EXPECT_EQ(input.not_driven, nullptr);
  EXPECT_TRUE(device_->has_force);
  write_until_it_is({{1, 2, 3}, Vec3::Zero()}, {1, 2, 3}, Vec3::Zero());
}

TEST_F(Touch, WriteIsSilentUntilAFrameTakesTheLastWrench) {
  open();
  await_frame();
  device_->hangs = true;
  std::this_thread::sleep_for(5ms);
  connection_->write({{1, 0, 0}, Vec3::Zero()});
  EXPECT_EQ(connection_->write({{2, 0, 0}, Vec3::Zero()}), ConnectionStatus::silent);
  device_->hangs = false;
  await_frame();
  EXPECT_EQ(connection_->write({{2, 0, 0}, Vec3::Zero()}), ConnectionStatus::fresh);
}

TEST_F(Touch, ReportsZeroAsSentOnlyOnceTheMotorsHaveIt) {
  open();
  EXPECT_EQ(connection_->write({}), ConnectionStatus::fresh);
  write_until_it_is({{3, 0, 0}, Vec3::Zero()}, {3, 0, 0}, Vec3::Zero());
  int rounds = 0;
  for (; connection_->write({}) != ConnectionStatus::fresh; ++rounds) {
    ASSERT_LT(rounds, 100);
    await_frame();
  }
  EXPECT_EQ(force(), Vec3::Zero());
  EXPECT_GE(rounds, 1);
}

TEST_F(Touch, ReadsColumnMajorTransformInMillimetres) {
  // A quarter turn about z: x of the handle, the first column, points along y.
  device_->transform = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 10, -20, 30, 1};
  device_->buttons = 2;
  open();
  DeviceInput input;
  ASSERT_EQ(read_until_it_is(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  EXPECT_EQ(input.X_BH.position_mm, Vec3(10, -20, 30));
  EXPECT_NEAR((rotation_vector(input.X_BH.orientation) - Vec3(0, 0, std::numbers::pi / 2)).norm(), 0, 1e-12);
  EXPECT_EQ(input.buttons, 2u);
}

TEST_F(Touch, SendsForceButNoTorqueWithThreeDrivenAxes) {
  open();
  write_until_it_is({{1, 2, 3}, {40, 50, 60}}, {1, 2, 3}, Vec3::Zero());
}

TEST_F(Touch, SendsTorqueInNewtonMillimetres) {
  device_->output_dof = 6;
  open();
  EXPECT_EQ(connection_->capabilities().limits.torque_Nmm, 188);
  write_until_it_is({Vec3::Zero(), {40, 50, 60}}, Vec3::Zero(), {40, 50, 60});
}

TEST_F(Touch, ForceIsZeroAfterAWrenchIsNotRenewed) {
  open();
  write_until_it_is({{1, 2, 3}, Vec3::Zero()}, {1, 2, 3}, Vec3::Zero());
  std::this_thread::sleep_for(30ms);
  await_frame();
  EXPECT_EQ(force(), Vec3::Zero());
}

TEST_F(Touch, IsSilentWhenHangingAndLostOnFailure) {
  open();
  DeviceInput input;
  // Warm motors do not count as a failure.
  device_->error = 0x0200;
  await_frame();
  EXPECT_EQ(read_until_it_is(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  device_->error = 0;
  device_->hangs = true;
  EXPECT_EQ(read_until_it_is(ConnectionStatus::silent, input), ConnectionStatus::silent);
  device_->hangs = false;
  EXPECT_EQ(read_until_it_is(ConnectionStatus::fresh, input), ConnectionStatus::fresh);
  device_->error = 0x0302;
  EXPECT_EQ(read_until_it_is(ConnectionStatus::lost, input), ConnectionStatus::lost);
  EXPECT_EQ(connection_->write({}), ConnectionStatus::lost);
}

TEST_F(Touch, ClosingSendsZero) {
  open();
  write_until_it_is({{1, 2, 3}, Vec3::Zero()}, {1, 2, 3}, Vec3::Zero());
  connection_.reset();
  EXPECT_EQ(force(), Vec3::Zero());
  EXPECT_FALSE(device_->is_open);
}

TEST_F(Touch, WhyThereIsNoneIsSaid) {
  EXPECT_EQ(refusal("Right"), "hd: the stand-in fails");
  device_->is_there = false;
  EXPECT_FALSE(hardware_named("hd")->find("").is_present);
  unsetenv("OSTEOMILL_HD_LIBRARY");
  EXPECT_EQ(refusal(),
            "hd: libHD.so of the vendor's software is not installed; OSTEOMILL_HD_LIBRARY can name its path");
}

}  // namespace
}  // namespace osteomill
