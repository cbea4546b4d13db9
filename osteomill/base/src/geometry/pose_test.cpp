#include "osteomill/base/pose.h"

#include <numbers>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(Pose, InverseMapsAPointBack) {
  const Pose X{{1, -2, 3}, quaternion_from_rotation_vector({0.3, -1.2, 0.4})};
  const Vec3 point(0.5, 4, -7);
  EXPECT_TRUE((X.inverse() * (X * point)).isApprox(point, 1e-12));
  EXPECT_TRUE(((X * X.inverse()) * point).isApprox(point, 1e-12));
}

TEST(Pose, ProductEqualsApplyingOneAfterTheOther) {
  const Pose A{{1, 2, 3}, quaternion_from_rotation_vector({0.1, 0.2, 0.3})};
  const Pose B{{-4, 0, 2}, quaternion_from_rotation_vector({-0.7, 0.1, 1.0})};
  const Vec3 point(3, -1, 2);
  EXPECT_TRUE(((A * B) * point).isApprox(A * (B * point), 1e-12));
}

TEST(Pose, RotationVectorSurvivesARoundTrip) {
  for (const Vec3& vector : {Vec3(0.3, -0.2, 2.0), Vec3(1e-9, 0, 0), Vec3(0, 3.1, 0), Vec3(0, 0, 0)}) {
    EXPECT_LT((rotation_vector(quaternion_from_rotation_vector(vector)) - vector).norm(), 1e-12);
  }
}

TEST(Pose, RotationVectorIsTheSameForANegatedQuaternion) {
  Quat turned = quaternion_from_rotation_vector({0, 0, 0.5});
  turned.coeffs() *= -1;
  EXPECT_LT((rotation_vector(turned) - Vec3(0, 0, 0.5)).norm(), 1e-12);
}

TEST(Pose, QuarterTurnAboutZMapsXToY) {
  const Quat turn = quaternion_from_rotation_vector({0, 0, std::numbers::pi / 2});
  EXPECT_LT((turn * Vec3::UnitX() - Vec3::UnitY()).norm(), 1e-12);
}

}  // namespace
}  // namespace osteomill
