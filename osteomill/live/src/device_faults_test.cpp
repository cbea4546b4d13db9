// Everything that can go wrong between an algorithm and a hand, from the bone to what the hand got: a session
// with its guard, a connected device, and hardware that fails, in simulated time.

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
// kHandWrenchRates in a millisecond.
constexpr double kMaxStep_N = 4 + 1e-6;
constexpr double kMaxStep_Nmm = 100 + 1e-6;
// How long it takes to know (an input or a wrench is old), and to come down.
constexpr int kTicksToKnow = 5;
constexpr int kTicksToZero = 5;

class DeviceFaults : public ::testing::TestWithParam<std::string> {
 protected:
  DeviceFaults() {
    device_.put_at({{0, 0, 3}, Quat::Identity()});
    press();
  }

  // Down onto the bone below z = 0, and into it; some feel the burr there, some the middle of it.
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
  // A device that is gone cannot be sent anything.
  Wrench felt() const { return hardware_.got.empty() ? Wrench{} : hardware_.last(); }
  double felt_N() const { return felt().force_N.norm(); }

  // The fault, then what the hand got: zero in time and from then on as long as it lasts.
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
  // All is well again, and comes up slowly.
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
  // It is driven again, and the hand feels nothing of the bone until it has left it.
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

TEST_P(DeviceFaults, VanishesAndComesBack) {
  expect_zero_after([this] { hardware_.gone = true; }, 1);
  // It cannot be sent anything while it is gone, and begins at zero.
  expect_return_from_outside([this] { hardware_.gone = false; });
  EXPECT_EQ(device_.report().reopened, 1u);
}

TEST_P(DeviceFaults, FallsSilent) {
  expect_zero_after([this] { hardware_.silent = true; }, kTicksToKnow + 1);
  EXPECT_EQ(record_.fault, WrenchFault::pose_not_finite);
  expect_slow_return([this] { hardware_.silent = false; });
}

// A force that is not felt pays for nothing: no bone is milled meanwhile.
TEST_P(DeviceFaults, IsNoLongerCalibrated) {
  const double before_mm3 = session_.removed_mm3();
  spindle_on_ = true;
  expect_zero_after([this] { hardware_.input.not_driven = "is not calibrated"; }, 1);
  EXPECT_TRUE(is_finite(record_.X_WD));
  // The tick in which it came was felt.
  EXPECT_LT(session_.removed_mm3() - before_mm3, 0.01);
  spindle_on_ = false;
  expect_return_from_outside([this] { hardware_.input.not_driven = nullptr; });
}

// A service that answers every 8 ms.
TEST_P(DeviceFaults, TakesAWrenchWithEveryPoseButRarely) {
  spindle_on_ = true;
  hardware_.got.clear();
  double max_N = 0;
  double before_mm3 = 0;
  for (int n = 0; n < 1000; ++n) {
    hardware_.silent = hardware_.busy = n % 8 != 0;
    tick();
    // The force felt before has fallen to zero by then.
    if (n == 50) before_mm3 = session_.removed_mm3();
    if (n > 50) max_N = std::max(max_N, felt_N());
  }
  EXPECT_LT(max_N, 1);
  // A force of that size pays for at most this in a second.
  EXPECT_LE(session_.removed_mm3() - before_mm3,
            0.01 + max_N * removal_rate_mm3_per_Ns(CuttingSettings{}, MillingTool{}.burr_radius_mm));
  expect_no_step();
}

TEST_P(DeviceFaults, GivesNumbersThatAreNone) {
  const Pose before = hardware_.input.X_BH;
  expect_zero_after(
      [this] { hardware_.input.X_BH.position_mm.y() = std::numeric_limits<double>::quiet_NaN(); }, 1);
  EXPECT_EQ(record_.fault, WrenchFault::pose_not_finite);
  expect_slow_return([&] { hardware_.input.X_BH = before; });
}

// Deeper into the bone, where 20 N would be asked for.
TEST_P(DeviceFaults, JumpsBy50mm) {
  const double before_N = felt_N();
  hardware_.got.clear();
  hardware_.input.X_BH.position_mm.y() -= 50;
  run(2);
  EXPECT_EQ(record_.fault, WrenchFault::pose_jumped);
  run(kTicksToZero);
  // The returning force rises by a hundredth of the limit in each tick.
  EXPECT_LE(felt_N(), std::min(before_N, 20 * 0.01 * (kTicksToZero + 1)) + 1e-9);
  run(200);
  expect_no_step();
}

TEST_P(DeviceFaults, IsSlow) {
  hardware_.got.clear();
  double max_N = 0;
  for (int n = 0; n < 1000; ++n) {
    hardware_.silent = n % 50 != 0;
    tick();
    if (n > kTicksToKnow + kTicksToZero) max_N = std::max(max_N, felt_N());
    // Between two inputs it has come down.
    if (n > 50 && n % 50 > kTicksToKnow + kTicksToZero + 1) {
      EXPECT_EQ(felt_N(), 0) << n;
    }
  }
  // In the few ticks of an input a blend only begins.
  EXPECT_LT(max_N, 1.5);
  expect_no_step();
}

TEST_P(DeviceFaults, TheHapticThreadHangs) {
  expect_zero_after([this] { hangs_ = true; }, kTicksToKnow + 1);
  EXPECT_EQ(device_.report().late_wrenches, 1u);
}

TEST_P(DeviceFaults, TicksComeLateBy5ms) {
  hardware_.got.clear();
  // The device's own thread goes on meanwhile.
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

TEST_P(DeviceFaults, TheProgramIsEnding) {
  expect_zero_after([this] { device_.disengage(); }, 0);
}

}  // namespace
}  // namespace osteomill
