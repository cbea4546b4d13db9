#include "barrier_shell/certificate.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/random.h"
#include "tool_move.h"

namespace osteomill::barrier_shell {
namespace {

using testing_support::random_vector;
using testing_support::uniform;

Vector6 move_of(const Vec3& delta_mm, const Vec3& omega_rad) {
  Vector6 move;
  move << delta_mm, omega_rad;
  return move;
}

Pose after(const Pose& X_WT, const Vector6& move, double t) {
  return moved(X_WT,
               {X_WT.orientation * Vec3(t * move.head<3>()), X_WT.orientation * Vec3(t * move.tail<3>())});
}

// For a million random cores, points and moves, small and large: everywhere on the path the point is at least
// as far from the core as certified, and after the certified share it keeps a tenth of its distance.
TEST(Certificate, NeverExceedsTheDistanceAlongThePath) {
  std::mt19937 bits(7);
  const Pose X_WT{{0.3, -0.2, 0.7}, quaternion_from_rotation_vector({0.4, 1.1, -0.3})};
  double worst = 0, min_kept = 1;
  for (int n = 0; n < 1000000; ++n) {
    const Cores cores{0.05 + std::abs(uniform(bits, -1, 1)) * 2, 0.05 + std::abs(uniform(bits, -1, 1)),
                      0.5 + std::abs(uniform(bits, -1, 1)) * 25};
    const Vec3 point_T(3 * uniform(bits, -1, 1), 3 * uniform(bits, -1, 1), 13 + 16 * uniform(bits, -1, 1));
    const double size = std::pow(10, 2 * uniform(bits, -1, 1) - 1);
    const Vec3 delta_mm = size * random_vector(bits);
    const Vector6 move = move_of(delta_mm, 0.1 * size * random_vector(bits));
    const Vec3 point_W = X_WT * point_T;
    const bool is_ball = n % 2 == 0;
    const auto distance_to = is_ball ? distance_to_ball : distance_to_cylinder;
    const CoreDistance now = distance_to(cores, point_T);
    if (now.distance_mm < 1e-6) continue;
    const double used =
        is_ball ? distance_used_by_ball(now.outward_T, move) : distance_used(point_T, now.outward_T, move);
    const double share = certified_fraction(std::max(0.0, used / now.distance_mm));
    // Checks the end of the certified move and a random point of it.
    for (const double t : {share, share * std::abs(uniform(bits, -1, 1))}) {
      const double then = distance_to(cores, after(X_WT, move, t).inverse() * point_W).distance_mm;
      const double bound = now.distance_mm - t * std::max(used, 0.0);
      worst = std::max(worst, bound - then);
      min_kept = std::min(min_kept, then / now.distance_mm);
    }
  }
  EXPECT_LE(worst, 1e-9);
  EXPECT_GE(min_kept, kMinDistanceShare - 1e-6);
}

// A point that slides along a core uses up none of its distance, however near; one that moves straight
// towards it uses up exactly the length of its path.
TEST(Certificate, IsExactForSlidingAndForDirectApproach) {
  const Cores cores{1.3, 0.8, 24.8};
  const Vec3 beside_ball(0, 0, -1.3001), beside_shaft(0.8001, 0, 12);
  const CoreDistance ball = distance_to_ball(cores, beside_ball);
  EXPECT_EQ(certified_fraction(distance_used_by_ball(ball.outward_T, move_of({0.4, 0, 0}, {0.1, 0.2, 0.3})) /
                               ball.distance_mm),
            1);
  const CoreDistance side = distance_to_cylinder(cores, beside_shaft);
  EXPECT_EQ(
      certified_fraction(distance_used(beside_shaft, side.outward_T, move_of({0, 0.3, 0.3}, Vec3::Zero())) /
                         side.distance_mm),
      1);
  EXPECT_NEAR(
      certified_fraction(distance_used(beside_shaft, side.outward_T, move_of({0.01, 0, 0}, Vec3::Zero())) /
                         side.distance_mm),
      0.9 * side.distance_mm / 0.01, 1e-12);
}

}  // namespace
}  // namespace osteomill::barrier_shell
