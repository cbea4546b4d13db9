#include "osteomill/session/connected_device.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"

#include "tests/scripted_device.h"
#include "tests/wait.h"

namespace osteomill {
namespace {

using State = DeviceReport::State;
constexpr double kTick_s = 1e-3;
constexpr int kBlend = 110;
// Change allowed by kHandWrenchRates in a tick.
constexpr double kMaxStep_N = 4 + 1e-6;
const Pose kStart{{5, 6, 7}, quaternion_from_rotation_vector({0, 0.3, 0})};

class ConnectedDeviceTest : public ::testing::Test {
 protected:
  ConnectedDeviceTest() {
    device_.put_at(kStart);
    run(kBlend);
  }
  // Runs a tick of the haptic thread, unless it hangs, and a round of the device's thread.
  void tick() {
    hardware_.now_s += kTick_s;
    // Simulates hand tremor.
    hardware_.input.X_BH.position_mm.x() += trembles_ ? 1e-3 * std::sin(300 * hardware_.now_s) : 0;
    if (!hangs_) {
      pose_ = device_.read_pose();
      device_.write_wrench(is_finite(pose_) ? asked_ : Wrench{});
      device_.tick_done(is_finite(pose_) ? pose_ : kStart, kTick_s);
    }
    device_.exchange();
  }
  void run(int ticks) {
    for (int n = 0; n < ticks; ++n) tick();
  }
  double felt_N() const { return hardware_.last().force_N.norm(); }
  void expect_no_step() const { EXPECT_LE(hardware_.largest_step().force_N.norm(), kMaxStep_N); }

  testing_support::ScriptedDevice hardware_;
  ConnectedDevice device_{hardware_.way(), hardware_.clock()};
  Wrench asked_;
  Pose pose_;
  bool hangs_ = false;
  bool trembles_ = true;
};

TEST_F(ConnectedDeviceTest, MovesToolWithHandleAndRotatesWrenchToDevice) {
  trembles_ = false;
  run(2);
  const Vec3 before_mm = pose_.position_mm;
  hardware_.input.X_BH.position_mm += Vec3(0, 1, 0);
  // Up on the screen is up on the patient; the force of bone below also points up.
  asked_.force_N = {0, 0, 3};
  run(3);
  EXPECT_NEAR((pose_.position_mm - before_mm - Vec3(0, 0, 1)).norm(), 0, 1e-12);
  EXPECT_NEAR((hardware_.last().force_N - Vec3(0, 3, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(device_.report().state, State::ok);
  EXPECT_EQ(device_.report().complaint(), "");
}

TEST_F(ConnectedDeviceTest, SendsZeroWithin10msWhenTheHapticThreadHangs) {
  asked_.force_N = {0, 0, 19};
  run(20);
  EXPECT_NEAR(felt_N(), 19, 1e-9);
  hangs_ = true;
  run(5);
  EXPECT_NEAR(felt_N(), 19, 1e-9);
  run(5);
  EXPECT_EQ(felt_N(), 0);
  EXPECT_EQ(device_.report().late_wrenches, 1u);
  expect_no_step();
}

TEST_F(ConnectedDeviceTest, ReturnsNoPoseWhileInputIsMissing) {
  hardware_.silent = true;
  run(5);
  EXPECT_TRUE(is_finite(pose_));
  run(2);
  EXPECT_FALSE(is_finite(pose_));
  EXPECT_EQ(device_.report().state, State::silent);
  EXPECT_NE(device_.report().complaint().find("no pose for"), std::string::npos);
  hardware_.silent = false;
  run(2);
  EXPECT_TRUE(is_finite(pose_));
  EXPECT_EQ(device_.report().faults, 1u);
}

// 20 inputs per second are too slow for haptics.
TEST_F(ConnectedDeviceTest, ReturnsNoPoseBetweenInputsOfASlowDevice) {
  int poses = 0;
  for (int n = 0; n < 1000; ++n) {
    hardware_.silent = n % 50 != 0;
    tick();
    poses += is_finite(pose_) ? 1 : 0;
  }
  EXPECT_LE(poses, 20 * 6);
  EXPECT_GE(device_.report().faults, 19u);
}

TEST_F(ConnectedDeviceTest, ReturnsNoPoseForNonFiniteOrUnnormalizedInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Pose before = hardware_.input.X_BH;
  for (const Pose& wrong : {Pose{{nan, 0, 0}, Quat::Identity()}, Pose{{0, 0, 0}, Quat(0, 0, 0, 0)},
                            Pose{{0, 0, 0}, Quat(nan, 0, 0, 0)}, Pose{{0, 0, 0}, Quat(2, 0, 0, 0)}}) {
    hardware_.input.X_BH = wrong;
    run(3);
    EXPECT_FALSE(is_finite(pose_));
    EXPECT_EQ(device_.report().state, State::not_finite);
    hardware_.input.X_BH = before;
    run(3);
    EXPECT_TRUE(is_finite(pose_));
  }
}

// A handle at rest returns identical readings because encoders have steps.
TEST_F(ConnectedDeviceTest, KeepsForceWhileTheHandleIsHeldStill) {
  trembles_ = false;
  asked_.force_N = {0, 0, 2};
  run(1000);
  EXPECT_EQ(device_.report().state, State::ok);
  EXPECT_NEAR(felt_N(), 2, 1e-9);
}

// In the first tick in contact with bone, milling uses the fraction delivered before.
TEST_F(ConnectedDeviceTest, DeliversZeroFractionInAirWhileNotDriven) {
  EXPECT_EQ(device_.delivered_fraction(), 1);
  hardware_.input.not_driven = "is not calibrated";
  run(2);
  EXPECT_EQ(device_.delivered_fraction(), 0);
}

TEST_F(ConnectedDeviceTest, ReadsPosesButSendsZeroWhileNotDriven) {
  asked_.force_N = {0, 0, 10};
  run(10);
  hardware_.input.not_driven = "is not calibrated";
  run(10);
  EXPECT_TRUE(is_finite(pose_));
  EXPECT_EQ(felt_N(), 0);
  EXPECT_EQ(device_.delivered_fraction(), 0);
  EXPECT_EQ(device_.report().complaint(), "is not driven: it is not calibrated");
  hardware_.input.not_driven = nullptr;
  run(10);
  EXPECT_GT(felt_N(), 0);
  EXPECT_LT(felt_N(), 1.1);
  run(kBlend);
  EXPECT_NEAR(felt_N(), 10, 1e-9);
  EXPECT_EQ(device_.report().state, State::ok);
  expect_no_step();
}

// The haptic thread is notified in the next tick, however short the interruption.
TEST_F(ConnectedDeviceTest, ReportsEveryInterruptionOfDrivingByTheNextTick) {
  EXPECT_TRUE(device_.is_driven());
  const auto ticks_not_driven = [&](int ticks) {
    int count = 0;
    for (int n = 0; n < ticks; ++n) {
      tick();
      count += device_.is_driven() ? 0 : 1;
    }
    return count;
  };
  hardware_.input.not_driven = "has braked";
  EXPECT_EQ(ticks_not_driven(20), 19);  // the first tick still read the previous input
  hardware_.input.not_driven = nullptr;
  EXPECT_EQ(ticks_not_driven(20), 2);
  hardware_.input.not_driven = "has braked";
  device_.exchange();
  hardware_.input.not_driven = nullptr;
  device_.exchange();
  EXPECT_EQ(ticks_not_driven(20), 1);
  device_.disengage();
  device_.engage();
  EXPECT_EQ(ticks_not_driven(20), 1);
  // A clutch leaves the tool where it is.
  device_.set_clutched(true);
  EXPECT_EQ(ticks_not_driven(20), 0);
  hardware_.gone = true;
  EXPECT_EQ(ticks_not_driven(20), 19);
}

TEST_F(ConnectedDeviceTest, KeepsReportingRemarkOfASlightlySlowDevice) {
  hardware_.input.remark = "answers after 9 ms";
  for (int n = 0; n < 200; ++n) {
    hardware_.silent = n % 9 != 0;
    tick();
    if (n > 9) {
      ASSERT_EQ(device_.report().complaint(), "answers after 9 ms");
    }
  }
  run(200);
  EXPECT_EQ(device_.report().state, State::silent);
}

// The device's own watchdog switches to zero.
TEST_F(ConnectedDeviceTest, RampsForceUpAfterADeviceWatchdogLapse) {
  hardware_.can.watchdog_s = 5e-3;
  asked_.force_N = {0, 0, 10};
  run(200);
  EXPECT_NEAR(felt_N(), 10, 1e-9);
  hardware_.busy = true;
  run(10);
  hardware_.busy = false;
  for (int n = 1; n <= 10; ++n) {
    tick();
    EXPECT_LT(felt_N(), 0.1 * n + 0.6);
  }
  run(kBlend);
  EXPECT_NEAR(felt_N(), 10, 1e-9);
}

TEST_F(ConnectedDeviceTest, SendsZeroAfterReopeningUncalibrated) {
  asked_.force_N = {0, 0, 10};
  run(10);
  hardware_.gone = true;
  run(10);
  hardware_.gone = false;
  hardware_.input.not_driven = "is not calibrated";
  hardware_.got.clear();
  run(1000);
  EXPECT_EQ(device_.report().reopened, 1u);
  for (const auto& got : hardware_.got) EXPECT_TRUE(is_zero(got.wrench_B));
}

TEST_F(ConnectedDeviceTest, ReportsRemarkWhileForceIsDelivered) {
  hardware_.input.remark = "changes forces";
  asked_.force_N = {0, 0, 2};
  run(3);
  EXPECT_NEAR(felt_N(), 2, 1e-9);
  EXPECT_EQ(device_.report().complaint(), "changes forces");
}

// The device accepts every third wrench; the step limit applies between accepted ones.
TEST_F(ConnectedDeviceTest, LimitsForceStepsToABusyDevice) {
  hardware_.got.clear();
  for (int n = 0; n < 300; ++n) {
    hardware_.busy = n % 3 != 0;
    asked_.force_N = {0, 0, n % 60 < 30 ? 19.0 : -19.0};
    tick();
    const Vec3 asked_B(0, asked_.force_N.z(), 0);
    EXPECT_EQ(device_.delivered_fraction(), sent_fraction(asked_B, hardware_.last().force_N)) << n;
  }
  EXPECT_EQ(hardware_.got.size(), 100u);
  expect_no_step();
}

TEST_F(ConnectedDeviceTest, RampsForceToZeroWhenTheDeviceIsLost) {
  asked_.force_N = {0, 0, 19};
  run(20);
  EXPECT_NEAR(felt_N(), 19, 1e-9);
  hardware_.reports_lost = true;
  tick();
  EXPECT_EQ(device_.report().state, State::lost);
  EXPECT_EQ(felt_N(), 0);
  expect_no_step();
}

TEST_F(ConnectedDeviceTest, ReopensALostDeviceAndKeepsTheToolPosition) {
  run(10);
  const Vec3 left_W = pose_.position_mm;
  hardware_.gone = true;
  run(700);
  const DeviceReport gone = device_.report();
  EXPECT_EQ(gone.state, State::lost);
  EXPECT_EQ(gone.reason, "scripted: cannot be had");
  EXPECT_FALSE(is_finite(pose_));
  EXPECT_EQ(hardware_.closed, 1);
  hardware_.gone = false;
  trembles_ = false;
  hardware_.input.X_BH.position_mm = {100, 0, 0};
  run(600);
  EXPECT_EQ(device_.report().state, State::ok);
  EXPECT_EQ(device_.report().reopened, 1u);
  EXPECT_LT((pose_.position_mm - left_W).norm(), 0.01);
}

TEST_F(ConnectedDeviceTest, RefusesADifferentDeviceOnReopening) {
  hardware_.gone = true;
  run(10);
  hardware_.gone = false;
  hardware_.can.name = "another";
  run(600);
  EXPECT_EQ(device_.report().state, State::lost);
  EXPECT_EQ(device_.report().reason, "another device is connected: another");
}

TEST_F(ConnectedDeviceTest, ReportsALostDeviceWhenTheConnectionThrows) {
  hardware_.throws = true;
  run(2);
  EXPECT_EQ(device_.report().state, State::lost);
  EXPECT_EQ(device_.report().reason, "the cable came off");
}

TEST_F(ConnectedDeviceTest, ClutchMovesTheHandleWithoutMovingTheTool) {
  trembles_ = false;
  hardware_.input.buttons = ConnectedDevice::kSpindleButton;
  run(3);
  EXPECT_TRUE(device_.is_spindle_requested());
  const Pose held = pose_;
  hardware_.input.buttons |= ConnectedDevice::kClutchButton;
  asked_.force_N = {0, 0, 1};
  run(3);
  EXPECT_FALSE(is_finite(pose_));
  EXPECT_FALSE(device_.is_spindle_requested());
  EXPECT_EQ(felt_N(), 0);
  hardware_.input.X_BH = {{40, -30, 20}, quaternion_from_rotation_vector({1, 0, 0})};
  run(3);
  hardware_.input.buttons = 0;
  run(3);
  EXPECT_LT((pose_.position_mm - held.position_mm).norm(), 1e-9);
  EXPECT_LT(pose_.orientation.angularDistance(held.orientation), 1e-7);
}

TEST_F(ConnectedDeviceTest, ViewChangeKeepsToolAndRedirectsHandMotion) {
  trembles_ = false;
  run(2);
  const Vec3 before_mm = pose_.position_mm;
  device_.set_view(quaternion_from_rotation_vector({0, 0, 1}));
  run(2);
  EXPECT_LT((pose_.position_mm - before_mm).norm(), 1e-12);
  hardware_.input.X_BH.position_mm += Vec3(0, 0, 2);
  run(2);
  EXPECT_LT((pose_.position_mm - before_mm - Vec3(0, 0, 2)).norm(), 1e-12);
}

TEST_F(ConnectedDeviceTest, LimitsWrenchToDeviceCapabilities) {
  asked_ = {{0, 0, 500}, {0, 9000, 0}};
  run(50);
  EXPECT_NEAR(felt_N(), 20, 1e-9);
  EXPECT_NEAR(hardware_.last().torque_Nmm.norm(), 500, 1e-9);
  expect_no_step();
}

TEST_F(ConnectedDeviceTest, SendsZeroAfterDisengagingUntilEngagedAgain) {
  asked_.force_N = {0, 0, 10};
  run(20);
  EXPECT_FALSE(device_.disengage());
  tick();
  EXPECT_FALSE(device_.disengage());
  run(4);
  EXPECT_TRUE(device_.disengage());
  run(20);
  EXPECT_EQ(felt_N(), 0);
  // Unless the program continues.
  device_.engage();
  run(10);
  EXPECT_GT(felt_N(), 0);
  EXPECT_LT(felt_N(), 1.1);
  expect_no_step();
}

// Runs the device's thread with the real clock.
class RunningDevice : public ::testing::Test {
 protected:
  // Answers at about 1 kHz, like a device.
  class StubConnection final : public Connection {
   public:
    explicit StubConnection(RunningDevice& test) : test_(test) { can_.name = "running"; }
    const DeviceCapabilities& capabilities() const override { return can_; }
    ConnectionStatus read(DeviceInput& input) override {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (test_.dumb_) return ConnectionStatus::silent;
      input.X_BH.position_mm.x() = 1e-3 * ++reads_;
      return ConnectionStatus::fresh;
    }
    ConnectionStatus write(const Wrench& wrench_B) override {
      test_.felt_N_ = wrench_B.force_N.norm();
      test_.max_N_ = std::max(test_.max_N_.load(), wrench_B.force_N.norm());
      return ConnectionStatus::fresh;
    }

   private:
    RunningDevice& test_;
    DeviceCapabilities can_;
    int reads_ = 0;
  };
  OpenConnection way() {
    return [this] { return std::make_unique<StubConnection>(*this); };
  }

  std::atomic<bool> dumb_{false};
  std::atomic<double> felt_N_{-1};
  std::atomic<double> max_N_{0};
};

TEST_F(RunningDevice, ReceivesZeroForceBeforeItIsClosed) {
  {
    ConnectedDevice device(way(), {});
    device.start();
    ASSERT_TRUE(testing_support::becomes_true_in_time([&] {
      device.write_wrench({{8, 0, 0}, Vec3::Zero()});
      return felt_N_ >= 8;
    }));
  }
  EXPECT_EQ(felt_N_, 0);
  EXPECT_EQ(max_N_, 8);
}

TEST_F(RunningDevice, IsRefusedWhenItGivesNoPose) {
  dumb_ = true;
  ConnectedDevice device(way(), {});
  EXPECT_THROW(device.start(), InputError);
}

}  // namespace
}  // namespace osteomill
