#include "app/simulate/tool_control.h"

#include <gtest/gtest.h>

namespace osteomill::app {
namespace {

constexpr PixelSize kSize{1280, 800};
const Camera kCamera = camera_on({Vec3(1, 2, 3), 10}, {0.2, 1, -0.6}, Vec3::UnitZ());
const Pose kStart{{2, 1, 4}, quaternion_from_rotation_vector({0.1, 0, 0.2})};

TEST(ToolControl, FollowsThePointerAtConstantDepthAndOrientation) {
  ToolInput input;
  input.moved_px = {40, -25};
  const Pose moved = moved_target(kStart, kStart, kCamera, kSize, input);
  const Eigen::Vector2d before = pixel_of(kCamera, kSize, kStart.position_mm);
  const Eigen::Vector2d after = pixel_of(kCamera, kSize, moved.position_mm);
  EXPECT_NEAR((after - before - Eigen::Vector2d(40, -25)).norm(), 0, 1e-6);
  EXPECT_NEAR(depth_of(kCamera, moved.position_mm), depth_of(kCamera, kStart.position_mm), 1e-9);
  EXPECT_TRUE(moved.orientation.isApprox(kStart.orientation));
}

TEST(ToolControl, WheelMovesTheToolAwayFromTheViewer) {
  ToolInput input;
  input.wheel = 3;
  const Pose moved = moved_target(kStart, kStart, kCamera, kSize, input);
  EXPECT_GT(depth_of(kCamera, moved.position_mm), depth_of(kCamera, kStart.position_mm) + 0.3);
}

TEST(ToolControl, TurnsAboutTheBurrWithThePointer) {
  ToolInput input;
  input.turning = true;
  input.moved_px = {30, 0};
  const Pose turned = moved_target(kStart, kStart, kCamera, kSize, input);
  EXPECT_EQ(turned.position_mm, kStart.position_mm);
  // The part in front of the burr, as seen by the viewer, moves to the right.
  const Vec3 front_T = kStart.orientation.conjugate() * kCamera.towards_viewer_W();
  EXPECT_GT((turned.orientation * front_T).dot(kCamera.right_W()), 0.1);
}

TEST(ToolControl, LimitsTargetDistanceAndAngleWhileTouchingBone) {
  ToolInput input;
  input.wheel = 1000;
  input.touching = true;
  const Pose moved = moved_target(kStart, kStart, kCamera, kSize, input);
  EXPECT_NEAR((moved.position_mm - kStart.position_mm).norm(), 6, 1e-9);
  input.wheel = 0;
  input.turning = true;
  input.moved_px = {10000, 0};
  EXPECT_LT(
      moved_target(kStart, kStart, kCamera, kSize, input).orientation.angularDistance(kStart.orientation),
      0.36);
}

TEST(ToolControl, SpaceMousePushMovesRightInProportionToTime) {
  ToolInput input;
  input.space_mouse.push = {0.5, 0, 0};
  input.passed_s = 0.1;
  const Pose moved = moved_target(kStart, kStart, kCamera, kSize, input);
  const Vec3 way = moved.position_mm - kStart.position_mm;
  EXPECT_NEAR(way.dot(kCamera.right_W()), way.norm(), 1e-9);
  input.passed_s = 0.2;
  const Pose further = moved_target(kStart, kStart, kCamera, kSize, input);
  EXPECT_NEAR((further.position_mm - kStart.position_mm).norm(), 2 * way.norm(), 1e-9);
}

}  // namespace
}  // namespace osteomill::app
