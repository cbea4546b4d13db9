#include "osteomill/session/simulated_handle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/session/hand.h"

namespace osteomill {
namespace {

constexpr int kSubstepsPerTick = 20;

HandleSettings exact_encoder() {
  HandleSettings settings;
  settings.position_step_mm = 0;
  settings.rotation_step_rad = 0;
  return settings;
}

void advance_many(SimulatedHandle& handle, const Wrench& other, int substeps) {
  for (int n = 0; n < substeps; ++n) handle.advance(other);
}

TEST(SimulatedHandle, AcceleratesUniformlyUnderAConstantWrench) {
  SimulatedHandle handle(exact_encoder(), {});
  const Wrench push{{0.6, 0, -0.3}, {0, 3.0, 0}};
  advance_many(handle, push, 10000);  // 0.5 s
  // 0.6 N on 0.3 kg is 2 m/s^2 = 2000 mm/s^2; 3 N mm on 3e-4 kg m^2 is 10 rad/s^2.
  EXPECT_NEAR(handle.pose().position_mm.x(), 0.5 * 2000 * 0.25, 0.03);
  EXPECT_NEAR(handle.pose().position_mm.z(), -0.5 * 1000 * 0.25, 0.02);
  EXPECT_NEAR(handle.velocity().linear_mm_s.x(), 1000.0, 1e-6);
  const Vec3 turned = rotation_vector(handle.pose().orientation);
  EXPECT_NEAR(turned.y(), 0.5 * 10 * 0.25, 2e-4);
  EXPECT_NEAR(turned.x(), 0, 1e-12);
  // Work: force times distance plus torque times angle.
  EXPECT_NEAR(handle.kinetic_energy_Nmm(), 0.6 * 250 + 0.3 * 125 + 3.0 * 1.25, 0.05);
}

struct Oscillator {
  double natural_rad_s;
  double damping_ratio;
  // Returns the free oscillation from `start` at rest towards 0.
  double at(double start, double time_s) const {
    const double damped_rad_s = natural_rad_s * std::sqrt(1 - damping_ratio * damping_ratio);
    const double angle = damped_rad_s * time_s;
    return start * std::exp(-damping_ratio * natural_rad_s * time_s) *
           (std::cos(angle) + damping_ratio * natural_rad_s / damped_rad_s * std::sin(angle));
  }
};

TEST(SimulatedHandle, MatchesTheAnalyticSpringMassDamperInAHand) {
  const HandSettings hand;
  // Both motions of the default hand and handle: sqrt(500 N/m / 0.3 kg) and 5 / (2 sqrt(500 * 0.3)).
  const Oscillator oscillator{std::sqrt(500 / 0.3), 5 / (2 * std::sqrt(150.0))};
  const Vec3 turn(0, 0.02, 0);
  SimulatedHandle handle(exact_encoder(), {{1, 0, 0}, quaternion_from_rotation_vector(turn)});
  for (int n = 1; n <= 10000; ++n) {
    handle.advance(hand_wrench(hand, {}, {}, handle.pose(), handle.velocity()));
    const double time_s = n * 50e-6;
    ASSERT_NEAR(handle.pose().position_mm.x(), oscillator.at(1.0, time_s), 2e-3) << time_s;
    ASSERT_NEAR(rotation_vector(handle.pose().orientation).y(), oscillator.at(0.02, time_s), 4e-5) << time_s;
  }
}

// The integrator must not add or remove energy, so that growth in a measurement is due to the loop.
TEST(SimulatedHandle, KeepsEnergyOnAnUndampedSpringWithin2PercentForAMinute) {
  constexpr double kStiffness = 40.0;  // N/mm
  SimulatedHandle handle(exact_encoder(), {{0.1, 0, 0}, Quat::Identity()});
  const auto energy = [&] {
    return handle.kinetic_energy_Nmm() + 0.5 * kStiffness * handle.pose().position_mm.squaredNorm();
  };
  const double at_first = energy();
  double min = at_first;
  double max = at_first;
  for (int n = 0; n < 60 * 20000; ++n) {
    handle.advance({-kStiffness * handle.pose().position_mm, Vec3::Zero()});
    min = std::min(min, energy());
    max = std::max(max, energy());
  }
  EXPECT_GT(min, 0.98 * at_first);
  EXPECT_LT(max, 1.02 * at_first);
}

TEST(SimulatedHandle, CommandActsAfterTheForceDelayUntilTheNextOne) {
  SimulatedHandle handle(HandleSettings{}, {});
  std::vector<double> acting_N;
  for (int tick = 0; tick < 3; ++tick) {
    handle.command({{1.0 + tick, 0, 0}, Vec3::Zero()});
    for (int n = 0; n < kSubstepsPerTick; ++n) {
      handle.advance({});
      acting_N.push_back(handle.motor_wrench().force_N.x());
    }
  }
  for (std::size_t n = 0; n < acting_N.size(); ++n) {
    // Substep n spans the time from n to n+1 times 0.05 ms; 0.3 ms are six of them.
    const double expected = n < 6 ? 0.0 : 1.0 + std::floor((static_cast<double>(n) - 6) / kSubstepsPerTick);
    EXPECT_EQ(acting_N[n], expected) << n;
  }
}

TEST(SimulatedHandle, KeepsEveryCommandIfTheDelayExceedsATick) {
  HandleSettings settings;
  settings.force_delay_s = 2.5e-3;
  SimulatedHandle handle(settings, {});
  for (int n = 0; n < 200; ++n) {
    if (n % kSubstepsPerTick == 0) handle.command({{1.0 + n / kSubstepsPerTick, 0, 0}, Vec3::Zero()});
    handle.advance({});
    const double expected = n < 50 ? 0.0 : 1.0 + std::floor((n - 50) / 20.0);
    EXPECT_EQ(handle.motor_wrench().force_N.x(), expected) << n;
  }
}

TEST(SimulatedHandle, ClampsTheMotorWrenchAndZeroesANonFiniteOne) {
  SimulatedHandle handle(HandleSettings{}, {});
  handle.command({{300, 0, -400}, {0, 6000, 0}});
  advance_many(handle, {}, 7);
  EXPECT_TRUE(handle.motor_wrench().force_N.isApprox(Vec3(12, 0, -16), 1e-12));
  EXPECT_TRUE(handle.motor_wrench().torque_Nmm.isApprox(Vec3(0, 500, 0), 1e-12));
  handle.command({{std::numeric_limits<double>::quiet_NaN(), 0, 0}, Vec3::Zero()});
  advance_many(handle, {}, 7);
  EXPECT_EQ(handle.motor_wrench().force_N, Vec3::Zero());
}

TEST(SimulatedHandle, EncoderRoundsToWholeSteps) {
  const Pose start{{0, 0, 0}, quaternion_from_rotation_vector({0, 2.5, 0.3})};
  SimulatedHandle handle(HandleSettings{}, start);
  EXPECT_LT(rotation_vector(handle.read().orientation * start.orientation.conjugate()).norm(), 1e-12);
  int different_readings = 0;
  Pose before = handle.read();
  for (int n = 0; n < 4000; ++n) {
    handle.advance({{0.01, 0.007, -0.004}, {0.03, -0.02, 0.01}});
    const Pose read = handle.read();
    const Vec3 steps = read.position_mm / 0.005;
    ASSERT_LT((steps - Vec3(steps.array().round())).norm(), 1e-6);
    ASSERT_LE((read.position_mm - handle.pose().position_mm).cwiseAbs().maxCoeff(), 0.0025 + 1e-12);
    const Vec3 rotation_steps = rotation_vector(start.orientation.conjugate() * read.orientation) / 1e-4;
    ASSERT_LT((rotation_steps - Vec3(rotation_steps.array().round())).norm(), 1e-6);
    ASSERT_LT(handle.pose().orientation.angularDistance(read.orientation), 1.0e-4);
    if (read.position_mm != before.position_mm) ++different_readings;
    before = read;
  }
  EXPECT_GT(different_readings, 10);
  EXPECT_LT(different_readings, 600);  // far fewer than substeps: readings repeat between encoder steps
}

// A handle with only the hand's damper, thrown against a penalty wall below z = 0.
class ReleasedHandle {
 public:
  ReleasedHandle(const HandleSettings& settings, double damping_N_s_per_m, double height_mm,
                 double speed_mm_s)
      : handle_(settings, {{0, 0, height_mm}, Quat::Identity()}) {
    hand_.stiffness_N_per_mm = 0;
    hand_.torsional_stiffness_Nmm_per_rad = 0;
    hand_.damping_Ns_per_mm = damping_N_s_per_m / 1000;
    // Accelerates it to its speed within one substep.
    const double force_N = settings.mass_kg * speed_mm_s / 1000 / settings.substep_s;
    handle_.advance({{0, 0, -force_N}, Vec3::Zero()});
  }
  // `both_ways`: a spring on both sides of z = 0, as if the handle never left the wall.
  void tick(double wall_N_per_mm, bool both_ways) {
    const double z_mm = handle_.read().position_mm.z();
    handle_.command(
        {{0, 0, both_ways ? -wall_N_per_mm * z_mm : -wall_N_per_mm * std::min(0.0, z_mm)}, Vec3::Zero()});
    for (int n = 0; n < kSubstepsPerTick; ++n) {
      handle_.advance(hand_wrench(hand_, {}, {}, handle_.pose(), handle_.velocity()));
    }
  }
  const SimulatedHandle& handle() const { return handle_; }

 private:
  SimulatedHandle handle_;
  HandSettings hand_;
};

// Colgate and Schenkel: a sampled wall is passive while K < 2 b / (T + 2 tau), with force delay tau.
constexpr double kDamping_Ns_per_m = 5.0;
constexpr double kPassiveLimit_N_per_mm = 2 * kDamping_Ns_per_m / (1e-3 + 2 * 0.3e-3) / 1000;

TEST(SimulatedHandle, PassiveWallReturnsLessEnergyThanItReceives) {
  for (int drop = 0; drop < 50; ++drop) {
    // Height steps incommensurate with the motion per tick, so that impacts occur at every sampling phase.
    ReleasedHandle released({}, kDamping_Ns_per_m, 0.5 + 0.0037 * drop, 60);
    while (released.handle().pose().position_mm.z() > 0) released.tick(0.9 * kPassiveLimit_N_per_mm, false);
    const double came = released.handle().kinetic_energy_Nmm();
    int ticks = 0;
    while (released.handle().pose().position_mm.z() <= 0 && ++ticks < 1000) {
      released.tick(0.9 * kPassiveLimit_N_per_mm, false);
    }
    ASSERT_LT(ticks, 1000);
    EXPECT_LT(released.handle().kinetic_energy_Nmm(), came) << drop;
  }
}

double swing_after(double wall_N_per_mm, int ticks) {
  ReleasedHandle released(exact_encoder(), kDamping_Ns_per_m, 0.01, 0);
  for (int n = 0; n < ticks; ++n) released.tick(wall_N_per_mm, true);
  double max_mm = 0;
  for (int n = 0; n < 200; ++n) {
    released.tick(wall_N_per_mm, true);
    max_mm = std::max(max_mm, std::abs(released.handle().pose().position_mm.z()));
  }
  return max_mm;
}

TEST(SimulatedHandle, OscillationDecaysBelowThePassivityLimitAndGrowsAboveIt) {
  EXPECT_LT(swing_after(0.9 * kPassiveLimit_N_per_mm, 4000), 0.001);
  EXPECT_GT(swing_after(1.1 * kPassiveLimit_N_per_mm, 4000), 0.02);
}

TEST(SimulatedHandle, RunAfterResetIsBitIdenticalToTheFirst) {
  const Pose start{{1, 2, 3}, quaternion_from_rotation_vector({0.1, 0.2, 0.3})};
  SimulatedHandle handle(HandleSettings{}, start);
  const auto run = [&] {
    handle.command({{1, 0, 0}, {0, 1, 0}});
    advance_many(handle, {{0, 0.3, 0}, Vec3::Zero()}, 100);
    return handle.pose();
  };
  const Pose first = run();
  handle.reset(start);
  const Pose again = run();
  EXPECT_EQ(first.position_mm, again.position_mm);
  EXPECT_EQ(first.orientation.coeffs(), again.orientation.coeffs());
}

TEST(SimulatedHandle, ASettingOutOfRangeIsRefused) {
  const auto refused = [](auto change) {
    HandleSettings settings;
    change(settings);
    EXPECT_THROW(SimulatedHandle(settings, {}), std::invalid_argument);
  };
  refused([](HandleSettings& s) { s.mass_kg = 0; });
  refused([](HandleSettings& s) { s.inertia_kg_m2 = -1; });
  refused([](HandleSettings& s) { s.substep_s = 0; });
  refused([](HandleSettings& s) { s.force_delay_s = -1e-3; });
  refused([](HandleSettings& s) { s.position_step_mm = std::numeric_limits<double>::quiet_NaN(); });
  refused([](HandleSettings& s) { s.limits.force_N = -1; });
  EXPECT_NO_THROW(SimulatedHandle(HandleSettings{}, {}));
}

}  // namespace
}  // namespace osteomill
