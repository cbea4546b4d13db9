#include "tool_move.h"

#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace osteomill {
namespace {

constexpr Release kNone{1e9, 0, 0};
constexpr double kTick_s = 1e-3;

TEST(ToolMove, MoveBetweenPosesReachesTheSecondPose) {
  const Pose from{{1, 2, 3}, quaternion_from_rotation_vector({0.1, 0.2, 0.3})};
  const Pose to{{4, 1, 3}, quaternion_from_rotation_vector({-0.7, 0.2, 0.9})};
  const Pose after = moved(from, move_between(from, to));
  EXPECT_LT((after.position_mm - to.position_mm).norm(), 1e-12);
  EXPECT_LT(rotation_vector(after.orientation * to.orientation.conjugate()).norm(), 1e-12);
}

TEST(ToolMove, LimitsTranslationAndRotationByTheSameFactor) {
  const Pose start{{1, 2, 3}, quaternion_from_rotation_vector({0.1, 0.2, 0.3})};
  const Pose target = moved(start, {{3, 0, 4}, {0, 0.1, 0}});
  const ToolMove by_length = move_between(start, moved_within({{}, 0.5, 0.05}, start, target));
  EXPECT_TRUE(by_length.translation_mm.isApprox(Vec3(0.3, 0, 0.4)));
  EXPECT_TRUE(by_length.rotation_rad.isApprox(Vec3(0, 0.01, 0)));
  const ToolMove by_angle = move_between(start, moved_within({{}, 10, 0.05}, start, target));
  EXPECT_TRUE(by_angle.translation_mm.isApprox(Vec3(1.5, 0, 2)));
  EXPECT_TRUE(by_angle.rotation_rad.isApprox(Vec3(0, 0.05, 0)));
  EXPECT_EQ(moved_within({{}, 10, 1}, start, target), target);
}

// A point of the tool on a frictionless surface, at a lever arm, with the device pressing further: the two
// springs let the tool follow a known part of the device's move, which needs no release.
TEST(ToolMove, BoundContainsTheMotionOfAToolGuidedByASurface) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  const double K = 2, K_r = 1000;
  int pressed = 0;
  for (int n = 0; n < 10000; ++n) {
    const Vec3 normal = vector().normalized(), about = (20 * vector()).cross(normal);
    Vec3 D = 0.3 * vector(), turn = 0.02 * vector();
    if (normal.dot(D) > 0) D = -D;
    if (about.dot(turn) > 0) turn = -turn;
    const double compliance = 1 / K + about.squaredNorm() / K_r;
    // The push that the last tick left, and its increase.
    const double push_N = std::abs(unit(random));
    const double grows_N = -(normal.dot(D) + about.dot(turn)) / compliance;
    const Pose device;
    const Pose tool = moved(device, {push_N / K * normal, push_N / K_r * about});
    const ToolMove led{D + grows_N / K * normal, turn + grows_N / K_r * about};
    const MoveBound bound =
        move_bound(tool, device, moved(device, {D, turn}), std::sqrt(K_r / K), {1e9, 1e-3, 1e-3}, kTick_s);
    EXPECT_EQ(share_within(bound, led), 1) << "push " << push_N;
    pressed += grows_N > 0.1 ? 1 : 0;
  }
  EXPECT_GT(pressed, 5000);
}

TEST(ToolMove, StationaryDeviceReleasesAtALimitedSpeedAndShare) {
  const Pose device;
  const Pose tool{{3, 0, 0}, quaternion_from_rotation_vector({0, 0.4, 0})};
  const MoveBound bound = move_bound(tool, device, device, 20, Release{}, kTick_s);
  const double may_mm = 3e-3 / 0.1 + 15e-3, may_rad = 0.4e-3 / 0.1 + 0.05e-3;
  EXPECT_NEAR(share_within(bound, {{-3, 0, 0}, Vec3::Zero()}), may_mm / 3, 1e-12);
  EXPECT_NEAR(share_within(bound, {Vec3::Zero(), {0, -0.4, 0}}), may_rad / 0.4, 1e-12);
  // Away from the device, only at the release speed, because the bone does not move.
  EXPECT_NEAR(share_within(bound, {{3, 0, 0}, Vec3::Zero()}), 15e-3 / 3, 1e-12);
  // No faster sideways: a falling force may change its direction only at a limited speed.
  EXPECT_LT(share_within(bound, {{0, 0.1, 0}, Vec3::Zero()}), 0.5);
  EXPECT_EQ(share_within(bound, {}), 1);
}

// Standing still is always within the bound, and so is moving with the device.
TEST(ToolMove, BoundAllowsStandingStillAndMovingWithTheDevice) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  for (int n = 0; n < 1000; ++n) {
    const Pose before, now = moved(before, {vector(), 0.1 * vector()});
    const MoveBound bound =
        move_bound(moved(before, {vector(), 0.1 * vector()}), before, now, 20, kNone, kTick_s);
    EXPECT_EQ(share_within(bound, {}), 1);
    EXPECT_GT(share_within(bound, move_between(before, now)), 1 - 1e-9);
  }
}

TEST(ToolMove, ShareEndsWhereTheChangeLeavesTheBall) {
  const Vec3 middle(1, 0, 0);
  const double share = share_within(middle, 2, {0, 1, 0}, {3, 4, -5});
  EXPECT_GT(share, 0);
  EXPECT_NEAR((Vec3(0, 1, 0) + share * Vec3(3, 4, -5) - middle).norm(), 2, 1e-12);
  EXPECT_EQ(share_within(middle, 2, {0, 1, 0}, {1, 0, 0}), 1);
  EXPECT_EQ(share_within(middle, 0.5, {0, 1, 0}, {1, 0, 0}), 0);
}

}  // namespace
}  // namespace osteomill
