#include "osteomill/session/hand.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

Pose turned(const Vec3& position_mm, const Vec3& rotation) {
  return {position_mm, quaternion_from_rotation_vector(rotation)};
}

TEST(Hand, PullsTowardsTheTargetWithItsStiffness) {
  const Wrench wrench = hand_wrench({}, turned({1, 0, -2}, {0, 0.01, 0}), {}, {}, {});
  EXPECT_TRUE(wrench.force_N.isApprox(Vec3(0.5, 0, -1), 1e-12));
  EXPECT_TRUE(wrench.torque_Nmm.isApprox(Vec3(0, 5, 0), 1e-9));
}

TEST(Hand, DampsTheMotionRelativeToTheTarget) {
  const Twist velocity{{10, 0, 0}, {0, 0, 2}};
  const Wrench alone = hand_wrench({}, {}, {}, {}, velocity);
  EXPECT_TRUE(alone.force_N.isApprox(Vec3(-0.05, 0, 0), 1e-12));
  EXPECT_TRUE(alone.torque_Nmm.isApprox(Vec3(0, 0, -10), 1e-12));
  const Wrench together = hand_wrench({}, {}, velocity, {}, velocity);
  EXPECT_EQ(together.force_N, Vec3::Zero());
  EXPECT_EQ(together.torque_Nmm, Vec3::Zero());
}

TEST(Hand, ClampsTheSpringForceToThePushLimitWithoutTurningIt) {
  const HandSettings hand;
  EXPECT_DOUBLE_EQ(torque_limit_Nmm(hand), 15.0);
  for (double stretch_mm : {0.5, 2.9, 3.1, 30.0, 3000.0}) {
    const Vec3 direction = Vec3(1, -2, 2) / 3;
    const Wrench wrench = hand_wrench(hand, turned(stretch_mm * direction, Vec3::Zero()), {}, {}, {});
    EXPECT_NEAR(wrench.force_N.norm(), std::min(1.5, 0.5 * stretch_mm), 1e-12);
    EXPECT_LT(wrench.force_N.cross(direction).norm(), 1e-12);
  }
  const Wrench far = hand_wrench(hand, turned({100, 0, 0}, {0, 0, 1.0}), {}, {}, {});
  EXPECT_NEAR(far.torque_Nmm.norm(), 15.0, 1e-12);
  // The push limit does not apply to the damper.
  const Wrench fast =
      hand_wrench(hand, turned({100, 0, 0}, Vec3::Zero()), {}, {}, {{-400, 0, 0}, Vec3::Zero()});
  EXPECT_NEAR(fast.force_N.x(), 1.5 + 2.0, 1e-12);
}

// Rotating the scene must rotate the wrench.
TEST(Hand, RotatingTheSceneRotatesTheWrench) {
  const Pose turn = turned({3, -4, 5}, {0.4, -0.8, 0.3});
  const Pose target = turned({1, 2, 0.5}, {0.01, 0.02, -0.005});
  const Pose device = turned({0.5, 1.5, 1}, {0.005, 0.01, 0.02});
  const Twist velocity{{1, -2, 3}, {0.1, 0.2, -0.3}};
  const Twist velocity_turned{turn.orientation * velocity.linear_mm_s,
                              turn.orientation * velocity.angular_rad_s};
  const Wrench plain = hand_wrench({}, target, {}, device, velocity);
  const Wrench other = hand_wrench({}, turn * target, {}, turn * device, velocity_turned);
  EXPECT_LT((turn.orientation * plain.force_N - other.force_N).norm(), 1e-12);
  EXPECT_LT((turn.orientation * plain.torque_Nmm - other.torque_Nmm).norm(), 1e-10);
}

TEST(Hand, ASettingOutOfRangeIsRefused) {
  HandSettings hand;
  EXPECT_NO_THROW(require_valid(hand));
  hand.push_N = -1;
  EXPECT_THROW(require_valid(hand), std::invalid_argument);
  hand = {};
  hand.damping_Ns_per_mm = std::nan("");
  EXPECT_THROW(require_valid(hand), std::invalid_argument);
}

TEST(RandomHand, StaysInThePublishedRangesAndSpansTheStiffnessRange) {
  double min = 1e9;
  double max = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const HandSettings hand = random_hand(seed);
    EXPECT_NO_THROW(require_valid(hand));
    EXPECT_GE(hand.stiffness_N_per_mm, 0.135);
    EXPECT_LE(hand.stiffness_N_per_mm, 1.0);
    EXPECT_GE(hand.damping_Ns_per_mm, 0.005);
    EXPECT_LE(hand.damping_Ns_per_mm, 0.010);
    EXPECT_NEAR(hand.torsional_stiffness_Nmm_per_rad / hand.stiffness_N_per_mm,
                hand.torsional_damping_Nmms_per_rad / hand.damping_Ns_per_mm, 1e-9);
    min = std::min(min, hand.stiffness_N_per_mm);
    max = std::max(max, hand.stiffness_N_per_mm);
  }
  EXPECT_LT(min, 0.17);
  EXPECT_GT(max, 0.96);
}

// A study names its hands by their seeds, so a seed must mean the same hand on every machine and in every
// version.
TEST(RandomHand, SeedGivesTheSameStiffnessOnEveryMachine) {
  EXPECT_EQ(random_hand(1).stiffness_N_per_mm, random_hand(1).stiffness_N_per_mm);
  EXPECT_NE(random_hand(1).stiffness_N_per_mm, random_hand(2).stiffness_N_per_mm);
  // The known first output of the 64-bit Mersenne twister for its default seed.
  EXPECT_EQ(
      random_hand(5489).stiffness_N_per_mm,
      0.135 + (1.0 - 0.135) * (static_cast<double>(14514284786278117030ULL >> 11) / 9007199254740992.0));
}

}  // namespace
}  // namespace osteomill
