#include "osteomill/session/virtual_hand.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

const Pose kStart{{1, 2, 3}, Quat::Identity()};

void let_pass(VirtualHand& hand, double seconds) {
  for (double t = 0; t < seconds; t += 1e-3) {
    hand.read_pose();
    hand.tick_done({}, 1e-3);
  }
}

TEST(VirtualHand, ReachesThePullTargetWithinOnePercentOvershoot) {
  VirtualHand hand({}, pointing_hand(), kStart);
  const Pose target{{6, 2, 3}, quaternion_from_rotation_vector({0, 0.4, 0})};
  hand.pull_to(target);
  double max_distance_mm = 0;
  for (int n = 0; n < 1000; ++n) {
    hand.tick_done({}, 1e-3);
    max_distance_mm = std::max(max_distance_mm, hand.read_pose().position_mm.x());
  }
  EXPECT_NEAR((hand.read_pose().position_mm - target.position_mm).norm(), 0, 0.02);
  EXPECT_NEAR(hand.read_pose().orientation.angularDistance(target.orientation), 0, 1e-3);
  EXPECT_LT(max_distance_mm, 6.05);
}

// The motors render a wall of 2 N/mm at z = 3; the hand pushes down with its maximum force.
TEST(VirtualHand, PushesNoHarderThanItsLimit) {
  for (const double push_N : {2.5, 1.0}) {
    HandSettings settings = pointing_hand();
    settings.push_N = push_N;
    VirtualHand hand({}, settings, kStart);
    hand.pull_to({{1, 2, -40}, Quat::Identity()});
    for (int n = 0; n < 3000; ++n) {
      const double sunk_mm = 3 - hand.read_pose().position_mm.z();
      hand.write_wrench({{0, 0, std::max(2 * sunk_mm, 0.0)}, Vec3::Zero()});
      hand.tick_done({}, 1e-3);
    }
    EXPECT_NEAR(2 * (3 - hand.read_pose().position_mm.z()), push_N, 0.05);
  }
}

TEST(VirtualHand, IgnoresANonFinitePullTarget) {
  VirtualHand hand({}, pointing_hand(), kStart);
  hand.pull_to({{NAN, 0, 0}, Quat::Identity()});
  let_pass(hand, 0.5);
  EXPECT_NEAR((hand.read_pose().position_mm - kStart.position_mm).norm(), 0, 0.005);
}

TEST(VirtualHand, StaysWhereItIsPutUntilItIsPulledAgain) {
  VirtualHand hand({}, pointing_hand(), Pose{});
  const auto pass = [&](int ticks) {
    for (int n = 0; n < ticks; ++n) hand.tick_done({}, 1e-3);
  };
  hand.pull_to({{5, 0, 0}, Quat::Identity()});
  pass(50);
  const Pose there{{-40, 7, 3}, quaternion_from_rotation_vector({0.3, 0, 0})};
  hand.put_at(there);
  pass(200);
  EXPECT_LT((hand.read_pose().position_mm - there.position_mm).norm(), 0.01);
  EXPECT_LT(hand.read_pose().orientation.angularDistance(there.orientation), 1e-3);
  hand.pull_to({{-38, 7, 3}, there.orientation});
  pass(1000);
  EXPECT_NEAR(hand.read_pose().position_mm.x(), -38, 0.05);
}

}  // namespace
}  // namespace osteomill
