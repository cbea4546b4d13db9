#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

class IsosurfaceTest : public ::testing::Test {
 protected:
  Volume ball_ = shape_volume(centred_cube(48, 0.25), ball(Vec3::Zero(), 4.0));
};

TEST_F(IsosurfaceTest, FirstCrossingIsOnTheBall) {
  for (const Vec3& direction : {Vec3(1, 0, 0), Vec3(1, 2, 3), Vec3(-1, 1, 0)}) {
    const auto crossing = first_crossing(ball_, 5.5 * direction.normalized(), Vec3::Zero());
    ASSERT_TRUE(crossing);
    EXPECT_NEAR(crossing->norm(), 4.0, 0.02);
    EXPECT_LE(density_at(ball_.grid(), *crossing), ball_.isovalue());
  }
}

TEST_F(IsosurfaceTest, SegmentThatMissesTheBallHasNoCrossing) {
  EXPECT_FALSE(first_crossing(ball_, {5, -5, 0}, {5, 5, 0}));
}

TEST_F(IsosurfaceTest, FirstCrossingIsTheStartIfInsideBone) {
  EXPECT_EQ(first_crossing(ball_, {1, 0, 0}, {9, 0, 0}), Vec3(1, 0, 0));
}

TEST_F(IsosurfaceTest, NormalPointsOutwardsAndIsAbsentAtCentre) {
  const Vec3 point = 4.0 * Vec3(1, -2, 2).normalized();
  const auto normal = outward_normal(ball_, point);
  ASSERT_TRUE(normal);
  EXPECT_GT(normal->dot(point.normalized()), 0.9998);
  EXPECT_FALSE(outward_normal(ball_, Vec3::Zero()));
}

}  // namespace
}  // namespace osteomill
