#include "osteomill/session/wrench_guard.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

constexpr double kTick_s = 1e-3;
// Largest default change per tick: 20 N and 500 N mm fall to zero in five ticks.
constexpr double kMaxStep_N = 4 + 1e-9;
constexpr double kMaxStep_Nmm = 100 + 1e-9;
const Pose kHere{{1, 2, 3}, Quat::Identity()};

Wrench down(double force_N) {
  return {{0, 0, -force_N}, {0, 10 * force_N, 0}};
}

// Returns a guard after free space and then a constant force, with the blend finished.
WrenchGuard holding(double force_N) {
  WrenchGuard guard;
  guard.filter({}, kHere, kTick_s);
  for (int n = 0; n < 10; ++n) guard.filter(down(force_N), kHere, kTick_s);
  return guard;
}

TEST(WrenchGuard, SendsAContactFromFreeSpaceAtOnce) {
  WrenchGuard guard;
  guard.filter({}, kHere, kTick_s);
  const SafeWrench safe = guard.filter(down(3), kHere, kTick_s);
  EXPECT_EQ(safe.wrench.force_N, down(3).force_N);
  EXPECT_EQ(safe.fault, WrenchFault::none);
}

TEST(WrenchGuard, ATickOfNoLengthGivesNumbers) {
  WrenchGuard simulated(GuardSettings::for_simulation());
  WrenchGuard guarded = holding(3);
  for (const double force_N : {3.0, 3.0, 5.0}) {
    EXPECT_EQ(simulated.filter(down(force_N), kHere, 0).wrench.force_N, down(force_N).force_N);
    EXPECT_EQ(guarded.filter(down(force_N), kHere, 0).wrench.force_N, down(3).force_N);
  }
}

TEST(WrenchGuard, RampsUpSlowlyAfterARestart) {
  WrenchGuard guard = holding(0);
  guard.restart();
  for (int n = 1; n <= 99; ++n) {
    const SafeWrench safe = guard.filter(down(6), kHere, kTick_s);
    ASSERT_NEAR(safe.wrench.force_N.norm(), 6 * 0.01 * n, 1e-9) << n;
    ASSERT_EQ(safe.fault, WrenchFault::rate_limited);
  }
  guard.filter(down(6), kHere, kTick_s);
  EXPECT_EQ(guard.filter(down(6), kHere, kTick_s).fault, WrenchFault::none);
}

TEST(WrenchGuard, HoldsBackTheWrenchUntilTheToolIsOutOfBone) {
  const auto held = [](WrenchGuard& guard, const Wrench& asked, bool is_free) {
    const SafeWrench safe = guard.filter(asked, kHere, kTick_s, is_free);
    return is_zero(safe.wrench) && safe.fault == WrenchFault::held_back;
  };
  WrenchGuard begun;
  WrenchGuard driven_again = holding(6);
  driven_again.hold_back();
  WrenchGuard in_its_place = holding(6);
  in_its_place.begin_from({}, true);
  for (WrenchGuard* guard : {&begun, &driven_again, &in_its_place}) {
    for (int n = 0; n < 200; ++n) {
      ASSERT_TRUE(held(*guard, down(6), true));
      ASSERT_TRUE(held(*guard, {{0, 0, 0.4}, {0, 13, 0}}, true));
      ASSERT_TRUE(held(*guard, down(0.4), false)) << "in bone some algorithms give no force";
    }
    EXPECT_EQ(guard->energy_given_Nmm(), 0);
    EXPECT_NEAR(guard->filter(down(0.4), kHere, kTick_s).wrench.force_N.norm(), 0.004, 1e-9);
    EXPECT_LT(guard->filter(down(6), kHere, kTick_s).wrench.force_N.norm(), 0.13);
  }
}

TEST(WrenchGuard, DoesNotHoldBackInSimulation) {
  WrenchGuard guard(GuardSettings::for_simulation());
  guard.hold_back();
  EXPECT_EQ(guard.filter(down(6), kHere, kTick_s, false).wrench.force_N, down(6).force_N);
}

TEST(WrenchGuard, LateTicksDoNotEnlargeTheRampSteps) {
  WrenchGuard guard = holding(0);
  guard.restart();
  double before_N = 0;
  for (int n = 0; n < 50; ++n) {
    const double sent_N = guard.filter(down(6), kHere, n % 2 ? kTick_s : 4 * kTick_s).wrench.force_N.norm();
    ASSERT_NEAR(sent_N - before_N, 0.06, 1e-9) << n;
    before_N = sent_N;
  }
}

TEST(WrenchGuard, LimitsTheForceStepPerTick) {
  WrenchGuard guard = holding(0);
  Vec3 before_N = Vec3::Zero();
  for (const double force_N : {15.0, -15.0, 3.0, 20.0, -20.0, 0.0}) {
    for (int n = 0; n < 3; ++n) {
      const Vec3 sent_N = guard.filter(down(force_N), kHere, kTick_s).wrench.force_N;
      ASSERT_LE((sent_N - before_N).norm(), kMaxStep_N);
      before_N = sent_N;
    }
  }
}

// Each fault is reported, 20 N fall to zero within 5 ms, and the wrench then rises slowly.
TEST(WrenchGuard, FaultReducesTheForceToZeroWithin5ms) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Fault {
    Wrench asked;
    Pose X_WD;
    double dt_s;
    WrenchFault name;
  };
  const Fault faults[] = {{{{nan, 0, 0}, Vec3::Zero()}, kHere, kTick_s, WrenchFault::not_finite},
                          {down(20), {{1, 2, 53}, Quat::Identity()}, kTick_s, WrenchFault::pose_jumped},
                          // The grip is recentred.
                          {down(20),
                           {kHere.position_mm, quaternion_from_rotation_vector({0, 0.3, 0})},
                           kTick_s,
                           WrenchFault::pose_jumped},
                          {down(20), kHere, 0.02, WrenchFault::tick_late}};
  for (const Fault& fault : faults) {
    WrenchGuard guard = holding(20);
    double sent_N = 20;
    Pose X_WD = fault.X_WD;
    for (int n = 0; n < 5; ++n) {
      // A device that jumps back and forth.
      if (n % 2 == 1 && fault.name == WrenchFault::pose_jumped)
        X_WD = kHere;
      else
        X_WD = fault.X_WD;
      const SafeWrench safe = guard.filter(fault.asked, X_WD, fault.dt_s);
      ASSERT_EQ(safe.fault, fault.name);
      ASSERT_LE(std::abs(sent_N - safe.wrench.force_N.norm()), kMaxStep_N);
      sent_N = safe.wrench.force_N.norm();
    }
    EXPECT_NEAR(sent_N, 0, 1e-9);
    EXPECT_LT(guard.filter(down(20), X_WD, kTick_s).wrench.force_N.norm(), 0.3);
  }
}

TEST(WrenchGuard, RampsUpSlowlyAfterAPause) {
  WrenchGuard guard = holding(6);
  for (int n = 0; n < 5; ++n) guard.filter_zero(kHere, kTick_s);
  EXPECT_TRUE(guard.is_at_rest());
  EXPECT_LT(guard.filter(down(10), kHere, kTick_s).wrench.force_N.norm(), 0.2);
}

TEST(WrenchGuard, BlendsFromTheWrenchSentByAnotherGuard) {
  WrenchGuard after(GuardSettings{{10, 500}});
  after.begin_from(holding(2).sent(), false);
  double before_N = 2;
  for (int n = 0; n < 200; ++n) {
    const double sent_N = after.filter(down(14), kHere, kTick_s).wrench.force_N.norm();
    ASSERT_GE(sent_N, before_N - 1e-9);
    ASSERT_LE(sent_N, before_N + 0.1);
    before_N = sent_N;
  }
  EXPECT_NEAR(before_N, 10, 1e-9);
}

TEST(WrenchGuard, FadesOutToZeroInSmallSteps) {
  WrenchGuard guard = holding(6);
  guard.fade_out();
  double before_N = 6;
  for (int n = 0; n < 101; ++n) {
    const double sent_N = guard.filter(down(6), kHere, kTick_s).wrench.force_N.norm();
    ASSERT_LE(std::abs(sent_N - before_N), 0.1);
    before_N = sent_N;
  }
  EXPECT_TRUE(guard.is_at_rest());
}

// A hand on flat bone with every algorithm; measures the largest steps between ticks.
class GuardedSession : public ::testing::TestWithParam<std::string> {
 protected:
  GuardedSession() : session_(make(GetParam())) { put(3); }

  std::unique_ptr<MillingSession> make(const std::string& algorithm) {
    return std::make_unique<MillingSession>(
        std::make_shared<Volume>(testing_support::shape_volume(
            testing_support::centred_cube(60, 0.25), testing_support::plane(Vec3::Zero(), Vec3::UnitZ()))),
        BoneDensities{0, 1000}, MillingSetup{.algorithm = algorithm_named(algorithm)});
  }
  void put(double height_mm) { device_.put({{0, 0, height_mm}, Quat::Identity()}); }
  void tick(int count) {
    for (int n = 0; n < count; ++n) {
      sent(session_->tick(device_, {.dt_s = kTick_s}).wrench);
    }
  }
  void sent(const Wrench& wrench) {
    EXPECT_LE((wrench.force_N - sent_.force_N).norm(), kMaxStep_N);
    EXPECT_LE((wrench.torque_Nmm - sent_.torque_Nmm).norm(), kMaxStep_Nmm);
    step_N_ = std::max(step_N_, (wrench.force_N - sent_.force_N).norm());
    sent_ = wrench;
  }
  // Moves the device from free space down to `height_mm` above the surface.
  void press(double height_mm) {
    for (double here_mm = 3; here_mm > height_mm; here_mm -= 0.02) {
      put(here_mm);
      tick(1);
    }
    tick(20);
    step_N_ = 0;
  }

  std::unique_ptr<MillingSession> session_;
  PosedDevice device_;
  Wrench sent_;
  double step_N_ = 0;
};
INSTANTIATE_TEST_SUITE_P(EveryAlgorithm, GuardedSession, ::testing::ValuesIn(algorithm_names()),
                         [](const auto& of) {
                           std::string name = of.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

// From free space, faster than a hand moves, up to the speed that the guard treats as a jump.
TEST_P(GuardedSession, KeepsWrenchStepsWithinLimitsOnAFastApproach) {
  double felt_N = 0;
  for (const double mm_a_tick : {0.9, 4.9, 5.1}) {
    session_ = make(GetParam());
    sent_ = {};
    for (double here_mm = 20; here_mm > -3; here_mm -= mm_a_tick) {
      put(here_mm);
      tick(1);
    }
    tick(200);
    felt_N = std::max(felt_N, sent_.force_N.norm());
  }
  EXPECT_GT(felt_N, 4);
}

TEST_P(GuardedSession, RampsUpAfterAPauseInWhichTheHandSank) {
  press(0.8);
  for (int n = 0; n < 50; ++n) {
    put(0.8 - 0.1 * n);
    sent(session_->tick(device_, {.dt_s = kTick_s, .paused = true}).wrench);
  }
  EXPECT_EQ(sent_.force_N, Vec3::Zero());
  step_N_ = 0;
  tick(200);
  EXPECT_LT(step_N_, 0.3);
}

// Also if the algorithm gives no force there, and on the way out.
TEST_P(GuardedSession, HoldsBackForceAfterAStartInBoneUntilTheToolIsOut) {
  for (const double height_mm : {0.5, -2.0, -6.0}) {
    session_ = make(GetParam());
    put(height_mm);
    tick(200);
    EXPECT_EQ(step_N_, 0) << height_mm;
    // One of the paper's algorithms is not finite that deep.
    EXPECT_NE(session_->tick(device_, {.dt_s = kTick_s}).fault, WrenchFault::none) << height_mm;
    for (double here_mm = height_mm; here_mm < 3; here_mm += 0.02) {
      put(here_mm);
      tick(1);
      EXPECT_LE(sent_.force_N.norm(), WrenchGuard::kFreeForce_N);
    }
    press(-0.7);
    EXPECT_GT(sent_.force_N.norm(), 0.5);
    put(3);
    tick(100);
    sent_ = {};
    step_N_ = 0;
  }
}

TEST_P(GuardedSession, SendsZeroWithin5msIfTheDeviceHasNoPose) {
  press(0.3);
  device_.put({Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), Quat::Identity()});
  tick(5);
  EXPECT_EQ(sent_.force_N, Vec3::Zero());
  EXPECT_EQ(sent_.torque_Nmm, Vec3::Zero());
}

TEST_P(GuardedSession, RampsUpSlowlyAfterThePoseJumps) {
  press(0.3);
  for (const double height_mm : {-50.0, -0.5}) {
    put(height_mm);
    EXPECT_EQ(session_->tick(device_, {.dt_s = kTick_s}).fault, WrenchFault::pose_jumped);
    sent_ = device_.sent();
    // At most a tenth of the blend to the requested force of up to 20 N.
    tick(10);
    EXPECT_LE(sent_.force_N.norm(), 2 + 1e-9) << height_mm;
  }
}

TEST_P(GuardedSession, SwitchingAlgorithmsKeepsWrenchStepsWithinLimits) {
  for (const std::string& other : algorithm_names()) {
    put(3);
    tick(10);
    press(0.3);
    auto next = make(other);
    std::swap(session_, next);
    session_->resume_from({Pose{{0, 0, 1.2}, Quat::Identity()}, next->handover().sent, false});
    tick(200);
    // One of the paper's algorithms may itself step between ticks, up to the guard's limit.
    if (other == default_algorithm().id.name) {
      EXPECT_LT(step_N_, 0.3);
    }
    session_ = make(GetParam());
    sent_ = {};
  }
}

TEST(SentFraction, IsTheProjectedFractionAndOneIfTheRequestUnderflows) {
  EXPECT_EQ(sent_fraction(Vec3(0, 2, 0), Vec3(3, 1, 0)), 0.5);
  EXPECT_EQ(sent_fraction(Vec3::Zero(), Vec3(1, 0, 0)), 1);
  EXPECT_EQ(sent_fraction(Vec3(1e-170, -1e-200, 0), Vec3(1e-171, 0, 0)), 1);
  EXPECT_EQ(sent_fraction(Vec3(1e-161, 0, 0), Vec3(0, 1, 0)), 0);
}

}  // namespace
}  // namespace osteomill
