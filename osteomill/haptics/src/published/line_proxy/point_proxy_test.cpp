#include "published/line_proxy/point_proxy.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

#include "tests/shapes.h"

namespace osteomill::line_proxy {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

class PointProxyOnPlane : public ::testing::Test {
 protected:
  Volume bone_ = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
};

TEST_F(PointProxyOnPlane, ReachesTheProbeOnAFreePath) {
  EXPECT_EQ(move_point_proxy(bone_, {0, 0, 2}, {1, 1, 0.5}), Vec3(1, 1, 0.5));
}

TEST_F(PointProxyOnPlane, StopsAtTheSurfacePointAboveTheProbe) {
  const Vec3 proxy = move_point_proxy(bone_, {0, 0, 2}, {0.8, -0.3, -1.5});
  EXPECT_LT((proxy - Vec3(0.8, -0.3, 0)).norm(), 1e-3);
}

TEST_F(PointProxyOnPlane, FollowsTheProbeBackOutOfBone) {
  const Vec3 proxy = move_point_proxy(bone_, {0, 0, 2}, {0.8, -0.3, -1.5});
  EXPECT_EQ(move_point_proxy(bone_, proxy, {0.8, -0.3, 0.1}), Vec3(0.8, -0.3, 0.1));
}

TEST_F(PointProxyOnPlane, LeavesBoneAlongTheNormalIfLeftInside) {
  const Vec3 proxy = move_point_proxy(bone_, {0, 0, -0.1}, {0, 0, -1});
  EXPECT_LT(proxy.norm(), 1e-3);
}

TEST_F(PointProxyOnPlane, IsCorrectForPointsFarOutsideTheGrid) {
  EXPECT_EQ(move_point_proxy(bone_, {1e9, 0, 1e9}, {1e9, 5, 1e9}), Vec3(1e9, 5, 1e9));
  const auto crossing = first_crossing(bone_, {0, 0, 1e9}, {0, 0, -1e9});
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(crossing->z(), 0.0, 1e-3);
}

TEST_F(PointProxyOnPlane, FindsTheNearestExitOnlyWithinReach) {
  const auto exit = nearest_exit(bone_, {0.3, 0.2, -2}, 5.0);
  ASSERT_TRUE(exit);
  EXPECT_LT((*exit - Vec3(0.3, 0.2, 0)).norm(), 1e-3);
  EXPECT_FALSE(nearest_exit(bone_, {0, 0, -3}, 2.0));
}

TEST(PointProxy, FollowsTheProbeAroundABall) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), ball(Vec3::Zero(), 4.0));
  Vec3 proxy(0, 0, 5);
  for (int n = 0; n <= 180; ++n) {
    const double angle = n * std::numbers::pi / 180;
    const Vec3 out(std::sin(angle), 0, std::cos(angle));
    proxy = move_point_proxy(bone, proxy, 3.0 * out);
    ASSERT_LT((proxy - 4.0 * out).norm(), 0.06) << n;
    ASSERT_FALSE(is_bone_at(bone, proxy)) << n;
  }
}

// A groove of two planes that meet at a right angle: the proxy of a probe below it rests in the groove.
TEST(PointProxy, RestsInAGroove) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), [](const Vec3& p) {
    return std::min((p.z() - p.x()), (p.z() + p.x())) * std::numbers::sqrt2 / 2;
  });
  Vec3 proxy(1.0, 0, 2.0);
  for (int n = 0; n < 5; ++n) proxy = move_point_proxy(bone, proxy, {0.2, 0.4, -1.5});
  EXPECT_LT(std::abs(proxy.x()), 0.25);
  EXPECT_NEAR(proxy.y(), 0.4, 0.05);
  EXPECT_LT(std::abs(proxy.z()), 0.25);
}

TEST(PointProxy, ReachesTheProbeAfterSlidingOverAnEdge) {
  // Bone below z = 0 and left of x = 0; the probe leaves through the side.
  const Volume bone =
      shape_volume(centred_cube(48, 0.25), [](const Vec3& p) { return std::max(p.z(), p.x()); });
  Vec3 proxy = move_point_proxy(bone, {-1, 0, 1}, {-1, 0, -0.5});
  EXPECT_NEAR(proxy.z(), 0.0, 1e-3);
  for (int n = 0; n < 5; ++n) proxy = move_point_proxy(bone, proxy, {0.5, 0, -0.5});
  EXPECT_EQ(proxy, Vec3(0.5, 0, -0.5));
}

// Central differences turn with the grid by several degrees on an oblique plane.
TEST(SurfaceNormal, MatchesAnObliquePlaneWithinHalfADegree) {
  for (const Vec3& axis : {Vec3(0, 0, 1), Vec3(1, 1, 0), Vec3(1, 2, 3), Vec3(0.1, 0.9, 0.2)}) {
    const Vec3 normal = axis.normalized();
    const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), normal));
    const Vec3 along = normal.unitOrthogonal();
    for (int n = 0; n < 40; ++n) {
      const auto found = surface_normal(bone, 0.037 * n * along);
      ASSERT_TRUE(found);
      EXPECT_GT(found->dot(normal), std::cos(0.5 * std::numbers::pi / 180)) << axis.transpose();
    }
  }
}

}  // namespace
}  // namespace osteomill::line_proxy
