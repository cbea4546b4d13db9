#include "osteomill/milling/cutting_reaction.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "osteomill/milling/burr_mill.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

constexpr double kRadius_mm = 1.5;
constexpr double kTick_s = 1e-3;

MillingSettings settings() {
  MillingSettings settings;
  settings.removal_rate_mm3_per_Ns = removal_rate_mm3_per_Ns({}, kRadius_mm);
  settings.reaction_share = CuttingSettings{}.tangential_share;
  return settings;
}

// Upright tool, hand above.
Pose upright(const Vec3& position_mm = Vec3::Zero()) {
  return {position_mm, Quat::Identity()};
}

Wrench settled(const Vec3& force_W_N, const Pose& X_WT = upright()) {
  CuttingReaction reaction(settings(), kRadius_mm);
  const double paid_N = paying_force_W_N(settings(), X_WT, force_W_N, true).norm();
  for (int n = 0; n < 500; ++n) {
    reaction.follow(X_WT, force_W_N, settings().removal_rate_mm3_per_Ns * paid_N * kTick_s, kTick_s);
  }
  return reaction.wrench();
}

// Integrates the resistance over a half ball in small surface elements.
Wrench by_pieces(const Vec3& force_W_N, const Vec3& spin_W) {
  const Vec3 ahead = force_W_N.normalized(), side = ahead.unitOrthogonal(), up = ahead.cross(side);
  Wrench sum;
  double weights = 0;
  for (int a = 0; a < 200; ++a) {
    for (int b = 0; b < 200; ++b) {
      const double polar = (a + 0.5) / 200 * std::numbers::pi / 2,
                   around = (b + 0.5) / 200 * 2 * std::numbers::pi;
      const Vec3 n =
          std::cos(polar) * ahead + std::sin(polar) * (std::cos(around) * side + std::sin(around) * up);
      const double weight = std::cos(polar) * std::sin(polar);
      const Vec3 held_back = -weight * settings().reaction_share * force_W_N.norm() * spin_W.cross(n);
      sum.force_N += held_back;
      sum.torque_Nmm += (kRadius_mm * n).cross(held_back);
      weights += weight;
    }
  }
  return {sum.force_N / weights, sum.torque_Nmm / weights};
}

TEST(CuttingReaction, MatchesIntegralOverSurfaceElements) {
  for (const Vec3& force_N : {Vec3(1.5, 0, 0), Vec3(0, 0, -1.5), Vec3(0.7, -0.3, -1.1)}) {
    const Wrench wrench = settled(force_N), pieces = by_pieces(force_N, -Vec3::UnitZ());
    EXPECT_LT((wrench.force_N - pieces.force_N).norm(), 1e-3) << force_N.transpose();
    EXPECT_LT((wrench.torque_Nmm - pieces.torque_Nmm).norm(), 1e-3) << force_N.transpose();
  }
}

// The burr turns clockwise as seen from the hand. Pressed to the right (+x), where its rim moves towards -y,
// it is pushed towards +y.
TEST(CuttingReaction, ForceOpposesRimVelocityAtTheContact) {
  const Wrench wrench = settled({1.5, 0, 0});
  EXPECT_NEAR(wrench.force_N.y(), 2.0 / 3.0 * 0.3 * 1.5, 1e-9);
  EXPECT_NEAR(wrench.force_N.x(), 0, 1e-12);
  EXPECT_NEAR(wrench.force_N.z(), 0, 1e-12);
  EXPECT_GT(wrench.torque_Nmm.z(), 0);
}

TEST(CuttingReaction, PayingForceIsLessAtThePoleAndLateralForcesCancel) {
  EXPECT_NEAR(paying_force_W_N(settings(), upright(), {2, 0, 0}, true).norm(), 1.5, 1e-12);
  EXPECT_NEAR(paying_force_W_N(settings(), upright(), {0, 0, -2}, true).norm(), 1.0, 1e-12);
  EXPECT_NEAR(settled({0, 0, -2}).force_N.norm(), 0, 1e-12) << "lateral forces cancel";
}

TEST(CuttingReaction, AllForcePaysAndWrenchIsZeroWithoutReaction) {
  MillingSettings off = settings();
  off.reaction_share = 0;
  EXPECT_EQ(paying_force_W_N(off, upright(), {0, 0, -2}, true), Vec3(0, 0, -2));
  EXPECT_EQ(paying_force_W_N(off, upright(), {0, 0, -2}, false), Vec3::Zero());
  CuttingReaction reaction(off, kRadius_mm);
  reaction.follow(upright(), {1, 0, 0}, 0.01, kTick_s);
  EXPECT_EQ(reaction.wrench().force_N.norm() + reaction.wrench().torque_Nmm.norm(), 0);
}

TEST(CuttingReaction, ForceAndItsChangePerTickAreBounded) {
  CuttingReaction reaction(settings(), kRadius_mm);
  const MillingSettings s = settings();
  double before_N = 0;
  for (int n = 0; n < 2000; ++n) {
    // Nothing for nine ticks, then the maximum that can be carried over at once.
    const double removed = n % 10 == 0 ? 10 * s.removal_rate_mm3_per_Ns * 2 * kTick_s : 0.0;
    reaction.follow(upright(), {2, 0, 0}, removed, kTick_s);
    const double force_N = reaction.wrench().force_N.norm();
    EXPECT_LE(force_N, 2 * s.reaction_share * 2);
    EXPECT_LE(std::abs(force_N - before_N), s.reaction_share * 2);
    before_N = force_N;
  }
  for (int n = 0; n < 200; ++n) reaction.follow(upright(), Vec3::Zero(), 0, kTick_s);
  EXPECT_EQ(reaction.wrench().force_N.norm(), 0) << "the spindle is off";
}

// The work of the spindle's torque equals the cost of the bone, whatever the burr's orientation.
TEST(CuttingReaction, SpindleWorkMatchesEnergyOfRemovedBone) {
  using testing_support::centred_cube;
  using testing_support::plane;
  using testing_support::shape_volume;
  const CuttingSettings cutting;
  for (const double tilt_rad : {0.0, 0.6, 1.4}) {
    const Vec3 into(std::sin(tilt_rad), 0, -std::cos(tilt_rad));
    Volume volume = shape_volume(centred_cube(60, 0.2), plane(Vec3::Zero(), -into), 1.25);
    BurrMill mill(volume, kRadius_mm, {0, 1000}, settings());
    CuttingReaction reaction(settings(), kRadius_mm);
    double removed_mm3 = 0, spindle_Nmm = 0;
    for (int n = 0; n < 2000; ++n) {
      const Pose X_WT = upright((-1.4 + 0.001 * n) * into);
      const Vec3 force_N = 1.5 * into;
      const MillingStep cut =
          mill.step(X_WT.position_mm, paying_force_W_N(settings(), X_WT, force_N, true), kTick_s);
      reaction.follow(X_WT, force_N, cut.removed_mm3, kTick_s);
      removed_mm3 += cut.removed_mm3;
      const double speed_rad_s = 2 * std::numbers::pi * cutting.spindle_speed_rpm / 60;
      spindle_Nmm += reaction.wrench().torque_Nmm.z() * speed_rad_s * kTick_s;
    }
    ASSERT_GT(removed_mm3, 2);
    EXPECT_NEAR(spindle_Nmm / (cutting.specific_energy_Nmm_per_mm3 * removed_mm3), 1, 0.01) << tilt_rad;
  }
}

}  // namespace
}  // namespace osteomill
