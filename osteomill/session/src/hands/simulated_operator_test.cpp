#include "osteomill/session/simulated_operator.h"

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/analytic_hole.h"

namespace {

std::atomic<long> allocations{0};

}  // namespace

// Counts allocations, to show that a tick allocates nothing. Not inlined, because GCC would warn of a
// mismatch of new and free.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace osteomill {
namespace {

using testing_support::AnalyticHole;

const MillingTool kTool;

OperatorSettings short_run(std::uint64_t seed = 1) {
  OperatorSettings settings;
  settings.script.milling_s = 4;
  settings.script.holding_s = 2;
  settings.seed = seed;
  return settings;
}

AnalyticHole hole_at(const MillingEntry& entry) {
  return {entry, kTool.burr_radius_mm, AnalyticHole::Kind::direct, 1.0};
}

std::vector<Pose> poses_of_a_run(const OperatorSettings& settings, double tick_s) {
  const MillingEntry entry;
  AnalyticHole hole = hole_at(entry);
  SimulatedOperator person(settings, kTool, entry);
  std::vector<Pose> poses;
  while (!person.finished()) {
    poses.push_back(person.read_pose());
    const auto step = hole.step(poses.back(), person.is_spindle_requested(), tick_s);
    person.write_wrench(step.wrench);
    person.tick_done(step.X_WT, tick_s);
  }
  return poses;
}

TEST(SimulatedOperator, IsBitIdenticalForTheSameSettingsAndDiffersForAnotherSeed) {
  const auto one = poses_of_a_run(short_run(3), 1e-3);
  const auto same = poses_of_a_run(short_run(3), 1e-3);
  const auto other = poses_of_a_run(short_run(4), 1e-3);
  ASSERT_EQ(one.size(), 6000u);
  int different = 0;
  for (std::size_t n = 0; n < one.size(); ++n) {
    ASSERT_EQ(one[n].position_mm, same[n].position_mm);
    ASSERT_EQ(one[n].orientation.coeffs(), same[n].orientation.coeffs());
    if (one[n].position_mm != other[n].position_mm) ++different;
  }
  EXPECT_GT(different, 5000);
}

TEST(SimulatedOperator, HandMotionDoesNotDependOnTheTickRate) {
  // In free space, before contact: 1 kHz, 500 Hz, 4 kHz.
  for (double tick_s : {2e-3, 0.25e-3}) {
    SimulatedOperator one(short_run(), kTool, {});
    SimulatedOperator other(short_run(), kTool, {});
    for (int n = 0; n < 400; ++n) {
      one.tick_done(one.read_pose(), 1e-3);
      one.tick_done(one.read_pose(), 1e-3);
      for (double passed_s = 0; passed_s < 2e-3 - 1e-9; passed_s += tick_s)
        other.tick_done(other.read_pose(), tick_s);
      ASSERT_NEAR(one.time_s(), other.time_s(), 1e-12);
      ASSERT_LT((one.target().position_mm - other.target().position_mm).norm(), 1e-9);
      ASSERT_LT((one.handle().pose().position_mm - other.handle().pose().position_mm).norm(), 1e-3);
    }
  }
}

TEST(SimulatedOperator, KeepsPartialSubstepsAndIgnoresInvalidTickLengths) {
  SimulatedOperator person(short_run(), kTool, {});
  for (int n = 0; n < 10; ++n) person.tick_done(person.read_pose(), 0.03e-3);
  EXPECT_NEAR(person.time_s(), 0.3e-3, 1e-12);
  for (double dt_s : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), 2.0})
    person.tick_done(person.read_pose(), dt_s);
  EXPECT_NEAR(person.time_s(), 0.3e-3, 1e-12);
  EXPECT_TRUE(is_finite(person.read_pose()));
}

TEST(SimulatedOperator, WrenchActsAfterTheForceDelay) {
  SimulatedOperator person(short_run(), kTool, {});
  person.write_wrench({{0, 0, 5}, Vec3::Zero()});
  person.tick_done(person.read_pose(), 0.3e-3);
  EXPECT_EQ(person.handle().motor_wrench().force_N, Vec3::Zero());
  person.tick_done(person.read_pose(), 0.05e-3);
  EXPECT_EQ(person.handle().motor_wrench().force_N, Vec3(0, 0, 5));
  EXPECT_NEAR(person.time_s(), 0.35e-3, 1e-12);
}

TEST(SimulatedOperator, TremorHasItsRmsAlongEachAxisWhileHolding) {
  OperatorSettings settings = short_run();
  settings.script.milling_s = 0;
  settings.script.settle_s = 0;
  settings.script.holding_s = 20;
  SimulatedOperator person(settings, kTool, {});
  EXPECT_FALSE(person.is_spindle_requested());
  Vec3 sum = Vec3::Zero();
  Vec3 squares = Vec3::Zero();
  int count = 0;
  while (!person.finished()) {
    person.tick_done(person.read_pose(), 1e-3);
    const Vec3 x = person.target().position_mm;
    sum += x;
    squares += x.cwiseProduct(x);
    ++count;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double mean = sum[axis] / count;
    EXPECT_NEAR(std::sqrt(squares[axis] / count - mean * mean), 0.02, 0.002);
  }
}

TEST(SimulatedOperator, TickAllocatesNoMemory) {
  const MillingEntry entry;
  AnalyticHole hole = hole_at(entry);
  SimulatedOperator person(short_run(), kTool, entry);
  const long before = allocations;
  while (!person.finished()) {
    const auto step = hole.step(person.read_pose(), person.is_spindle_requested(), 1e-3);
    person.write_wrench(step.wrench);
    person.tick_done(step.X_WT, 1e-3);
  }
  EXPECT_EQ(allocations - before, 0);
  // The counter works (a direct call, because a new-expression may be optimized away).
  ::operator delete(::operator new(1));
  EXPECT_GT(allocations - before, 0);
}

TEST(SimulatedOperator, RandomHandsAreStillAtTheEndOfTheScript) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    OperatorSettings settings = short_run(seed);
    settings.hand = random_hand(seed);
    settings.script.milling_s = 8;
    const auto poses = poses_of_a_run(settings, 1e-3);
    for (std::size_t n = poses.size() - 500; n < poses.size(); ++n) {
      ASSERT_LT((poses[n].position_mm - poses.back().position_mm).norm(), 0.3) << seed;
    }
  }
}

TEST(SimulatedOperator, AHandTooStiffForTheSubstepIsRefused) {
  OperatorSettings settings;
  settings.hand.stiffness_N_per_mm = 400;
  EXPECT_NO_THROW(SimulatedOperator(settings, kTool, {}));
  settings.hand.stiffness_N_per_mm = 400000;
  EXPECT_THROW(SimulatedOperator(settings, kTool, {}), std::invalid_argument);
  settings.hand = {};
  settings.hand.torsional_damping_Nmms_per_rad = 1e7;
  EXPECT_THROW(SimulatedOperator(settings, kTool, {}), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
