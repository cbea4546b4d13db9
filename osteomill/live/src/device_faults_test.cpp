// Faults on the whole path from the bone to the hand: a session with its guard, a connected device, and
// failing hardware, in simulated time.

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "osteomill/base/wrench.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"

#include "tests/scripted_device.h"
#include "tests/shapes.h"

namespace osteomill {
namespace {

constexpr double kTick_s = 1e-3;
// kHandWrenchRates times 1 ms.
constexpr double kMaxStep_N = 4 + 1e-6;
constexpr double kMaxStep_Nmm = 100 + 1e-6;
// Ticks until a stale input or wrench is detected, and until the wrench is zero.
constexpr int kTicksToKnow = 5;
constexpr int kTicksToZero = 5;

class DeviceFaults : public ::testing::TestWithParam<std::string> {
 protected:
  DeviceFaults() {
    device_.put_at({{0, 0, 3}, Quat::Identity()});
    press();
  }

  // Moves down onto the bone below z = 0 and into it; algorithms sense contact at the burr's surface or at
  // its centre.
  void press() {
    for (int n = 0; n < 900 && (n == 0 || felt_N() < 2); ++n) {
      hardware_.input.X_BH.position_mm.y() -= 0.01;
      tick();
    }
    run(50);
    EXPECT_GT(felt_N(), 1);
    EXPECT_EQ(record_.fault, WrenchFault::none);
  }
  void lift() {
    for (int n = 0; n < 500; ++n) {
      hardware_.input.X_BH.position_mm.y() += 0.01;
      tick();
    }
  }

  void tick(double dt_s = kTick_s) {
    hardware_.now_s += dt_s;
    hardware_.input.X_BH.position_mm.x() = 1e-3 * std::sin(300 * hardware_.now_s);
    if (!hangs_) {
      record_ = session_.tick(device_, {.time_s = hardware_.now_s, .dt_s = dt_s, .spindle_on = spindle_on_});
    }
    device_.exchange();
  }
  void run(int ticks) {
    for (int n = 0; n < ticks; ++n) tick();
  }
  // Nothing can be sent to a disconnected device.
  Wrench felt() const { return hardware_.got.empty() ? Wrench{} : hardware_.last(); }
  double felt_N() const { return felt().force_N.norm(); }

  // Injects the fault and checks the wrench sent: zero in time, and from then on as long as the fault lasts.
  void expect_zero_after(const std::function<void()>& fault, int ticks_to_know) {
    hardware_.got.clear();
    fault();
    run(ticks_to_know + kTicksToZero);
    for (int n = 0; n < 200; ++n) {
      EXPECT_TRUE(is_zero(felt())) << n;
      tick();
    }
    expect_no_step();
  }
  // Ends the fault; the wrench returns slowly.
  void expect_slow_return(const std::function<void()>& mend) {
    hardware_.got.clear();
    mend();
    for (int n = 0; n < 10; ++n) {
      tick();
      // A tenth of the limit.
      EXPECT_LE(felt_N(), 2) << n;
    }
    run(700);
    EXPECT_EQ(record_.fault, WrenchFault::none);
    EXPECT_TRUE(is_finite(record_.X_WD));
    expect_no_step();
  }
  // Ends the fault; the hand feels no bone until it has left it.
  void expect_return_from_outside(const std::function<void()>& mend) {
    hardware_.got.clear();
    mend();
    run(700);
    EXPECT_TRUE(record_.driven);
    lift();
    EXPECT_EQ(record_.fault, WrenchFault::none);
    for (const auto& got : hardware_.got) EXPECT_LE(got.wrench_B.force_N.norm(), WrenchGuard::kFreeForce_N);
    press();
    expect_no_step();
  }
  void expect_no_step() const {
    const Wrench step = hardware_.largest_step();
    EXPECT_LE(step.force_N.norm(), kMaxStep_N);
    EXPECT_LE(step.torque_Nmm.norm(), kMaxStep_Nmm);
  }

  testing_support::ScriptedDevice hardware_;
  ConnectedDevice device_{hardware_.way(), hardware_.clock()};
  MillingSession session_{
      std::make_shared<Volume>(testing_support::shape_volume(
          testing_support::centred_cube(60, 0.25), testing_support::plane(Vec3::Zero(), Vec3::UnitZ()))),
      {0, 1000},
      {.algorithm = algorithm_named(GetParam())}};
  TickRecord record_;
  bool hangs_ = false;
  bool spindle_on_ = false;
};
INSTANTIATE_TEST_SUITE_P(EveryAlgorithm, DeviceFaults, ::testing::ValuesIn(algorithm_names()),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(DeviceFaults, ReconnectedDeviceGetsNoContactForceUntilOutsideBone) {
  expect_zero_after([this] { hardware_.gone = true; }, 1);
  // Nothing can be sent while it is disconnected; it then begins at zero.
  expect_return_from_outside([this] { hardware_.gone = false; });
  EXPECT_EQ(device_.report().reopened, 1u);
}

TEST_P(DeviceFaults, SilentDeviceGetsZeroThenASlowReturn) {
  expect_zero_after([this] { hardware_.silent = true; }, kTicksToKnow + 1);
  EXPECT_EQ(record_.fault, WrenchFault::pose_not_finite);
  expect_slow_return([this] { hardware_.silent = false; });
}

// A force that is not rendered must not mill: no bone is removed meanwhile.
TEST_P(DeviceFaults, UncalibratedDeviceGetsZeroAndRemovesNoBone) {
  const double before_mm3 = session_.removed_mm3();
  spindle_on_ = true;
  expect_zero_after([this] { hardware_.input.not_driven = "is not calibrated"; }, 1);
  EXPECT_TRUE(is_finite(record_.X_WD));
  // The force was still rendered in the tick of the fault.
  EXPECT_LT(session_.removed_mm3() - before_mm3, 0.01);
  spindle_on_ = false;
  expect_return_from_outside([this] { hardware_.input.not_driven = nullptr; });
}

// A device service that answers every 8 ms.
TEST_P(DeviceFaults, DeviceAnsweringEvery8msGetsLessThan1N) {
  spindle_on_ = true;
  hardware_.got.clear();
  double max_N = 0;
  double before_mm3 = 0;
  for (int n = 0; n < 1000; ++n) {
    hardware_.silent = hardware_.busy = n % 8 != 0;
    tick();
    // The earlier force has fallen to zero by then.
    if (n == 50) before_mm3 = session_.removed_mm3();
    if (n > 50) max_N = std::max(max_N, felt_N());
  }
  EXPECT_LT(max_N, 1);
  // Maximum removal in one second for a force of that size.
  EXPECT_LE(session_.removed_mm3() - before_mm3,
            0.01 + max_N * removal_rate_mm3_per_Ns(CuttingSettings{}, MillingTool{}.burr_radius_mm));
  expect_no_step();
}

TEST_P(DeviceFaults, NonFinitePoseGivesZeroThenASlowReturn) {
  const Pose before = hardware_.input.X_BH;
  expect_zero_after(
      [this] { hardware_.input.X_BH.position_mm.y() = std::numeric_limits<double>::quiet_NaN(); }, 1);
  EXPECT_EQ(record_.fault, WrenchFault::pose_not_finite);
  expect_slow_return([&] { hardware_.input.X_BH = before; });
}

// Jumps deeper into the bone, to a penetration that would ask for 20 N.
TEST_P(DeviceFaults, JumpOf50mmIsDetectedAndTheForceReturnsSlowly) {
  const double before_N = felt_N();
  hardware_.got.clear();
  hardware_.input.X_BH.position_mm.y() -= 50;
  run(2);
  EXPECT_EQ(record_.fault, WrenchFault::pose_jumped);
  run(kTicksToZero);
  // The returning force rises by a hundredth of the limit per tick.
  EXPECT_LE(felt_N(), std::min(before_N, 20 * 0.01 * (kTicksToZero + 1)) + 1e-9);
  run(200);
  expect_no_step();
}

TEST_P(DeviceFaults, DeviceAnsweringEvery50msGetsZeroBetweenInputs) {
  hardware_.got.clear();
  double max_N = 0;
  for (int n = 0; n < 1000; ++n) {
    hardware_.silent = n % 50 != 0;
    tick();
    if (n > kTicksToKnow + kTicksToZero) max_N = std::max(max_N, felt_N());
    // Between two inputs the force has fallen to zero.
    if (n > 50 && n % 50 > kTicksToKnow + kTicksToZero + 1) {
      EXPECT_EQ(felt_N(), 0) << n;
    }
  }
  // A blend only begins in the few ticks of one input.
  EXPECT_LT(max_N, 1.5);
  expect_no_step();
}

TEST_P(DeviceFaults, HungHapticThreadGivesZeroWrench) {
  expect_zero_after([this] { hangs_ = true; }, kTicksToKnow + 1);
  EXPECT_EQ(device_.report().late_wrenches, 1u);
}

TEST_P(DeviceFaults, TicksLateBy5msGiveZeroForce) {
  hardware_.got.clear();
  // The device's own thread keeps running meanwhile.
  for (int late = 0; late < 20; ++late) {
    for (int n = 0; n < 5; ++n) {
      hardware_.now_s += kTick_s;
      hardware_.input.X_BH.position_mm.x() = 1e-3 * std::sin(300 * hardware_.now_s);
      device_.exchange();
    }
    hardware_.now_s += kTick_s;
    record_ = session_.tick(device_, {.time_s = hardware_.now_s, .late_s = 5e-3});
    device_.exchange();
    EXPECT_EQ(record_.fault, WrenchFault::tick_late);
    if (late >= 5) {
      EXPECT_EQ(felt_N(), 0) << late;
    }
  }
  expect_no_step();
}

TEST_P(DeviceFaults, DisengagedDeviceGetsZeroWrench) {
  expect_zero_after([this] { device_.disengage(); }, 0);
}

}  // namespace
}  // namespace osteomill
