#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "osteomill/session/simulated_handle.h"
#include "osteomill/session/wrench_guard.h"

namespace osteomill {
namespace {

constexpr double kTick_s = 1e-3;
// Enough substeps to make the integrator's energy error negligible.
constexpr int kSubsteps = 200;

// A handle pressed by an undamped hand against a wall at z = 0 that is far too stiff for it: any excess
// energy from the wall remains in the handle's motion.
struct Wall {
  double stiffness_N_per_mm = 20;
  double press_N = 0;

  WrenchGuard guard{GuardSettings::for_simulation()};
  SimulatedHandle handle{exact(), {{0, 0, 1}, Quat::Identity()}};
  double kinetic_mJ = 0;
  double max_given_Nmm = 0;
  double deepest_mm = 0;

  static HandleSettings exact() {
    HandleSettings settings;
    settings.position_step_mm = settings.rotation_step_rad = settings.force_delay_s = 0;
    settings.substep_s = kTick_s / kSubsteps;
    return settings;
  }

  void run(int ticks) {
    for (int n = 0; n < ticks; ++n) {
      const double depth_mm = std::max(0.0, -handle.read().position_mm.z());
      handle.command(
          guard.filter({{0, 0, stiffness_N_per_mm * depth_mm}, Vec3::Zero()}, handle.read(), kTick_s).wrench);
      for (int substep = 0; substep < kSubsteps; ++substep) handle.advance({{0, 0, -press_N}, Vec3::Zero()});
      max_given_Nmm = std::max(max_given_Nmm, guard.energy_given_Nmm());
      if (n > ticks / 2) deepest_mm = std::max(deepest_mm, depth_mm);
    }
    kinetic_mJ = handle.kinetic_energy_Nmm();
  }
};

TEST(PassivityObserver, EnergyGivenMatchesTheEnergyThatTheHandleGains) {
  Wall wall;
  wall.press_N = 2;
  wall.run(400);
  // The handle's energy minus the work of the hand's force since the start 1 mm above.
  const double by_the_hand_Nmm = wall.press_N * (1 - wall.handle.pose().position_mm.z());
  wall.guard.filter({}, wall.handle.read(), kTick_s);
  EXPECT_NEAR(wall.guard.energy_given_Nmm(), wall.kinetic_mJ - by_the_hand_Nmm,
              0.01 * wall.guard.energy_given_Nmm());
}

TEST(PassivityObserver, CountsTheWorkOfATorque) {
  PassivityObserver observer;
  observer.move_to({});
  observer.send({Vec3::Zero(), {0, 0, 40}});
  observer.move_to({Vec3::Zero(), quaternion_from_rotation_vector({0, 0, 0.1})});
  EXPECT_NEAR(observer.energy_given_Nmm(), 4, 1e-9);
  observer.move_to({Vec3::Zero(), quaternion_from_rotation_vector({0, 0, -0.1})});
  EXPECT_NEAR(observer.energy_given_Nmm(), -4, 1e-9);
}

TEST(PassivityObserver, AStiffWallIsActiveWithoutTheControllerAndPassiveWithIt) {
  Wall active;
  active.press_N = 2;
  active.run(4000);
  Wall controlled{.guard = WrenchGuard(GuardSettings::for_simulation({}, true))};
  controlled.press_N = 2;
  controlled.run(4000);
  EXPECT_GT(active.max_given_Nmm, 100);
  EXPECT_GT(active.deepest_mm, 10);
  // The next contact takes back the energy given in the last tick of a contact, so it does not accumulate.
  EXPECT_LT(controlled.max_given_Nmm, 1);
  EXPECT_LT(controlled.deepest_mm, 1);
}

TEST(PassivityObserver, SendsZeroInFreeSpaceAndDampsTheNextContact) {
  WrenchGuard guard(GuardSettings::for_simulation({}, true));
  Pose X_WD;
  // Moves 1 mm along the force: 3 N mm of excess energy.
  guard.filter({{3, 0, 0}, Vec3::Zero()}, X_WD, kTick_s);
  X_WD.position_mm.x() += 1;
  EXPECT_EQ(guard.filter({}, X_WD, kTick_s).wrench.force_N, Vec3::Zero());
  EXPECT_NEAR(guard.energy_given_Nmm(), 3, 1e-12);
  // The next contact takes it back by reducing the requested wrench.
  X_WD.position_mm.x() += 1;
  const SafeWrench safe = guard.filter({{3, 0, 0}, Vec3::Zero()}, X_WD, kTick_s);
  EXPECT_LT(safe.wrench.force_N.x(), 3);
  EXPECT_EQ(safe.fault, WrenchFault::rate_limited);
}

TEST(PassivityObserver, SkipsTheMotionAcrossANonFinitePose) {
  PassivityObserver observer;
  observer.move_to({});
  observer.send({{1, 0, 0}, Vec3::Zero()});
  observer.move_to({Vec3::Constant(std::numeric_limits<double>::quiet_NaN()), Quat::Identity()});
  observer.move_to({{50, 0, 0}, Quat::Identity()});
  EXPECT_EQ(observer.energy_given_Nmm(), 0);
  observer.move_to({{51, 0, 0}, Quat::Identity()});
  EXPECT_EQ(observer.energy_given_Nmm(), 1);
}

}  // namespace
}  // namespace osteomill
