#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "published/line_proxy/intersection.h"
#include "tests/shapes.h"

namespace osteomill::line_proxy {
namespace {

using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

// Bone beyond x = 1; a shaft of five vertices along z.
class WalkToCollision : public ::testing::Test {
 protected:
  Pose tilted(double angle_rad, double x) const {
    return {Vec3(x, 0, -2), quaternion_from_rotation_vector(Vec3(0, angle_rad, 0))};
  }
  std::optional<WalkHit> walk(const Pose& from, const Pose& to) const {
    return walk_to_collision(bone_, shaft_T_, from, to, {4, 4});
  }

  Volume bone_ = shape_volume(centred_cube(48, 0.25), plane(Vec3(1, 0, 0), -Vec3::UnitX()));
  std::vector<Vec3> shaft_T_{{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}};
};

TEST_F(WalkToCollision, ReturnsNothingWithoutACollision) {
  EXPECT_FALSE(walk(tilted(0, -1), tilted(0, 0.9)));
}

// Translated from x = 0 to 1.6 in steps of 0.4: the third step, from 0.8 to 1.2, collides halfway.
TEST_F(WalkToCollision, StopsATranslationAtTheFirstCollidingStep) {
  const auto hit = walk(tilted(0, 0), tilted(0, 1.6));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->before_W.x(), 0.8, 1e-12);
  EXPECT_NEAR(hit->at_W.x(), 1.2, 1e-12);
  EXPECT_NEAR(hit->fraction, 0.5, 1e-6);
  EXPECT_NEAR(hit->intersection_W().x(), 1.0, 1e-6);
}

// When the shaft tilts about the tip, its far end arrives first.
TEST_F(WalkToCollision, FindsTheShaftsEndCollidingDuringARotation) {
  const Pose from = tilted(0, 0.2);
  const Pose to = tilted(std::asin(0.25), 0.2);  // the far end reaches x = 1.2, the vertex before it 0.95
  const auto hit = walk(from, to);
  ASSERT_TRUE(hit);
  const Vec3 point = hit->intersection_W();
  EXPECT_NEAR(point.x(), 1.0, 0.01);
  EXPECT_NEAR((point - from.position_mm).norm(), 4.0, 0.01);
}

TEST_F(WalkToCollision, ReportsTheVertexThatCrossesFirst) {
  const auto hit = walk(tilted(0.3, -0.5), tilted(0.3, 1.5));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->at_W.z(), -2 + 4 * std::cos(0.3), 1e-9);
}

TEST_F(WalkToCollision, FractionIsFarBelowZeroForAVertexAlreadyInside) {
  const Pose from = tilted(0, 1.10);
  const Pose to = tilted(0, 1.11);
  const auto printed = walk(from, to);
  ASSERT_TRUE(printed);
  EXPECT_LT(printed->fraction, -30.0);
}

TEST_F(WalkToCollision, FractionIsNotFiniteForAVertexAtRestInside) {
  const auto hit = walk(tilted(0, 2.5), tilted(0, 2.5));
  ASSERT_TRUE(hit);
  EXPECT_FALSE(std::isfinite(hit->fraction));
}

}  // namespace
}  // namespace osteomill::line_proxy
