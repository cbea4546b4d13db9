#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/haptics/milling_tool.h"

namespace osteomill {
namespace {

const MillingTool kTool{1.5, 1.0, 25.0};

TEST(ToolDistance, MatchesExpectedDistancesAtKnownPoints) {
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {0, 0, 0}).distance_mm, -1.5);
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {3, 0, 0}).distance_mm, 1.5);
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {0, 0, -2}).distance_mm, 0.5);
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {0, 1.25, 10}).distance_mm, 0.25);
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {0, 0.5, 10}).distance_mm, -0.5);
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {0.2, 0, 26}).distance_mm, 1.0);
  EXPECT_DOUBLE_EQ(tool_distance(kTool, {4, 0, 29}).distance_mm, 5.0);
}

// The distance changes by 1 mm per mm along its gradient, and no faster in any direction.
TEST(ToolDistance, DirectionIsTheGradientOfTheDistance) {
  for (int n = 0; n < 500; ++n) {
    const Vec3 point = Vec3(3, 3, 14).cwiseProduct(Vec3::Random()) + Vec3(0, 0, 12);
    const ToolDistance here = tool_distance(kTool, point);
    Vec3 gradient;
    constexpr double kStep = 1e-6;
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = kStep * Vec3::Unit(axis);
      gradient[axis] =
          (tool_distance(kTool, point + step).distance_mm - tool_distance(kTool, point - step).distance_mm) /
          (2 * kStep);
    }
    if (gradient.norm() < 0.99) continue;  // a crease of the surface lies within the step
    EXPECT_LT((here.outward_T - gradient).norm(), 1e-5) << point.transpose();
  }
}

TEST(ToolDistance, DirectionIsAUnitVectorOnTheAxis) {
  for (const Vec3& point : {Vec3(0, 0, 0), Vec3(0, 0, 12), Vec3(0, 0, 25)}) {
    EXPECT_DOUBLE_EQ(tool_distance(kTool, point).outward_T.norm(), 1.0);
  }
}

TEST(MillingTool, RefusesSizesThatAreNotPositiveAndFinite) {
  EXPECT_NO_THROW(require_valid(kTool));
  EXPECT_THROW(require_valid({0, 1, 25}), std::invalid_argument);
  EXPECT_THROW(require_valid({1.5, -1, 25}), std::invalid_argument);
  EXPECT_THROW(require_valid({1.5, 1, std::numeric_limits<double>::infinity()}), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
