#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "barrier_shell/coupling.h"
#include "barrier_shell/near_points.h"
#include "tests/random.h"
#include "tool_move.h"

namespace osteomill::barrier_shell {
namespace {

using testing_support::random_vector;
using testing_support::uniform;

constexpr Barrier kBarrier{0.25, 3.0};

TEST(Barrier, PressureAndStiffnessMatchDerivativesOfTheEnergy) {
  constexpr double kStep = 1e-6;
  for (const double distance : {0.002, 0.01, 0.05, 0.12, 0.2, 0.249}) {
    const Barrier::Value here = kBarrier.at(distance);
    const Barrier::Value nearer = kBarrier.at(distance - kStep), farther = kBarrier.at(distance + kStep);
    EXPECT_NEAR(here.pressure, (nearer.energy - farther.energy) / (2 * kStep), 1e-4 * here.pressure + 1e-9);
    EXPECT_NEAR(here.stiffness, (nearer.pressure - farther.pressure) / (2 * kStep),
                1e-4 * here.stiffness + 1e-6);
  }
}

TEST(Barrier, VanishesBeyondItsWidthAndStartsSmoothly) {
  EXPECT_EQ(kBarrier.at(0.25).energy, 0);
  EXPECT_EQ(kBarrier.at(1).pressure, 0);
  EXPECT_LT(kBarrier.at(0.25 - 1e-6).stiffness, 1e-3);
  EXPECT_GT(kBarrier.at(1e-9).pressure, 1e5);
}

// Checks the derivatives along the path x + R t delta, R exp(t omega).
template <typename Energy>
void expect_derivatives(const Pose& X_WT, const EnergySum& sum, const Energy& energy, std::mt19937& bits,
                        double step, double tolerance) {
  for (int n = 0; n < 4; ++n) {
    Vector6 move;
    move << random_vector(bits), 0.2 * random_vector(bits);
    const auto at = [&](double t) {
      return energy(moved(
          X_WT, {X_WT.orientation * Vec3(t * move.head<3>()), X_WT.orientation * Vec3(t * move.tail<3>())}));
    };
    const double before = at(-step), here = at(0), after = at(step);
    EXPECT_NEAR(here, sum.energy_Nmm, 1e-12 * (1 + here));
    const double slope = sum.gradient.dot(move), bend = move.dot((sum.convex + sum.rest) * move);
    EXPECT_NEAR((after - before) / (2 * step), slope, tolerance * (1 + std::abs(slope)));
    EXPECT_NEAR((after - 2 * here + before) / (step * step), bend, tolerance * (1 + std::abs(bend)));
  }
}

TEST(EnergySum, DerivativesMatchTheEnergyForEveryPartOfBothCores) {
  std::mt19937 bits(3);
  const MillingTool tool{1.5, 1.0, 9};
  const Cores cores = Cores::within(tool, 0.2);
  int side = 0, end = 0, rim = 0, ball = 0;
  for (int n = 0; n < 20000 && (side < 20 || end < 20 || rim < 20 || ball < 20); ++n) {
    const Pose X_WT{random_vector(bits), quaternion_from_rotation_vector(2 * random_vector(bits))};
    const Vec3 point_T(1.4 * uniform(bits, -1, 1), 1.4 * uniform(bits, -1, 1), 4 + 6 * uniform(bits, -1, 1));
    const Vec3 point_W = X_WT * point_T;
    for (const auto& distance_to : {distance_to_ball, distance_to_cylinder}) {
      const double d = distance_to(cores, point_T).distance_mm;
      if (d < 0.03 || d > 0.24) continue;
      const bool is_ball = distance_to == distance_to_ball;
      const double rho = point_T.head<2>().norm();
      const bool beyond = point_T.z() < -0.01 || point_T.z() > cores.cylinder_length_mm + 0.01;
      const bool beside = rho > cores.cylinder_radius_mm + 0.01;
      if (!is_ball && beyond && !beside && rho > cores.cylinder_radius_mm - 0.01) continue;
      (is_ball ? ball : !beyond ? side : beside ? rim : end) += 1;
      EnergySum sum;
      const CoreDistance distance = distance_to(cores, point_T);
      add_point(sum, 0.02 * kBarrier.at(distance.distance_mm), point_T, distance);
      expect_derivatives(
          X_WT, sum,
          [&](const Pose& X) {
            return 0.02 * kBarrier.at(distance_to(cores, X.inverse() * point_W).distance_mm).energy;
          },
          bits, 2e-5, 2e-3);
    }
  }
  EXPECT_GE(std::min({side, end, rim, ball}), 20);
}

TEST(Coupling, DerivativesMatchTheEnergyBelowAndAtTheForceLimit) {
  std::mt19937 bits(4);
  const Coupling coupling{2.0, 1000.0};
  for (int n = 0; n < 40; ++n) {
    const double far = n % 2 == 0 ? 1 : 20;
    const Pose X_WD{far * random_vector(bits),
                    quaternion_from_rotation_vector((n % 4 < 2 ? 0.2 : 0.9) * random_vector(bits))};
    const Pose X_WT{random_vector(bits), quaternion_from_rotation_vector(0.2 * random_vector(bits))};
    expect_derivatives(
        X_WT, coupling.sum(X_WT, X_WD), [&](const Pose& X) { return coupling.energy_Nmm(X, X_WD); }, bits,
        1e-4, 1e-4);
    const Wrench wrench = coupling.wrench_on_hand(X_WT, X_WD);
    EXPECT_LE(wrench.force_N.norm(), 20 * (1 + 1e-12));
    EXPECT_LE(wrench.torque_Nmm.norm(), 500 * (1 + 1e-12));
    // The wrench on the hand is the energy's gradient with respect to tool motion.
    EXPECT_NEAR(
        (wrench.force_N - X_WT.orientation * Vec3(coupling.sum(X_WT, X_WD).gradient.head<3>())).norm(), 0,
        1e-9);
  }
}

}  // namespace
}  // namespace osteomill::barrier_shell
