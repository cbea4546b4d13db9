#include "osteomill/visual/scene.h"

#include <gtest/gtest.h>

#include "osteomill/visual/annotations.h"

namespace osteomill {
namespace {

const MillingTool kTool;
const Pose kX_WT{{1, 2, 3}, quaternion_from_rotation_vector({0.3, -0.5, 0.1})};

Wrench force_at(const Vec3& point_W, const Vec3& force_N) {
  return {force_N, (point_W - kX_WT.position_mm).cross(force_N)};
}

TEST(PointOfAction, IsContactPointOfSingleForceOnBurr) {
  for (const Vec3& direction : {Vec3(0, 0, -1), Vec3(1, 1, -1), Vec3(-1, 0.2, 0)}) {
    const Vec3 point_W =
        kX_WT.position_mm + kX_WT.orientation * (kTool.burr_radius_mm * direction.normalized());
    const auto found = point_of_action(kTool, kX_WT, force_at(point_W, kX_WT.position_mm - point_W));
    ASSERT_TRUE(found);
    EXPECT_NEAR((*found - point_W).norm(), 0, 1e-6);
  }
}

TEST(PointOfAction, IsContactPointOfSingleForceOnShaft) {
  const Vec3 point_W = kX_WT * Vec3(kTool.shaft_radius_mm, 0, 9);
  const Vec3 force_N = kX_WT.orientation * Vec3(-2, 0, 0);
  const auto found = point_of_action(kTool, kX_WT, force_at(point_W, force_N));
  ASSERT_TRUE(found);
  EXPECT_NEAR((*found - point_W).norm(), 0, 1e-6);
}

TEST(PointOfAction, IsAbsentWithoutForce) {
  EXPECT_FALSE(point_of_action(kTool, kX_WT, Wrench{}));
}

TEST(PointOfAction, IsOnBurrIfLineOfForceMissesTool) {
  const auto found = point_of_action(kTool, kX_WT, {{0, 0, 1}, {500, 0, 0}});
  ASSERT_TRUE(found);
  EXPECT_NEAR((*found - kX_WT.position_mm).norm(), kTool.burr_radius_mm, 1e-9);
}

TEST(RedPoint, IsIntersectionPointOrElsePointOfAction) {
  ViewScene scene;
  EXPECT_FALSE(red_point_W(scene));
  scene.X_WT = kX_WT;
  scene.wrench = {{0, 0, 2}, {5, 0, 0}};
  EXPECT_EQ(red_point_W(scene), point_of_action(scene.tool, kX_WT, scene.wrench));
  scene.intersection_W = Vec3(4, -1, 7);
  EXPECT_EQ(red_point_W(scene), scene.intersection_W);
}

TEST(Annotations, ScaleBarMeasuresLengthsAtFocus) {
  const PixelSize size{1000, 700};
  const Camera camera = camera_on({Vec3(1, 2, 3), 20}, Vec3::UnitY(), Vec3::UnitZ());
  const Annotation bar = scale_bar_annotation(camera, size);
  EXPECT_EQ(bar.text, "10 mm at the centre");
  const Eigen::Vector2d end = pixel_of(camera, size, camera.focus_W + 10 * camera.right_W());
  EXPECT_NEAR(bar.lines[0].to.x() - bar.lines[0].from.x(), end.x() - 500, 1e-9);
}

TEST(Annotations, ScaleBarHasRoundLengthThatFits) {
  const auto length = [](double max_mm) {
    const PixelSize size{1000, 1000};
    Camera camera;
    camera.field_of_view_rad = 0.04;
    camera.distance_mm *= 4 * max_mm / (1000 * mm_per_pixel(camera, size, camera.distance_mm));
    return scale_bar_annotation(camera, size).text;
  };
  EXPECT_EQ(length(6.3), "5 mm");
  EXPECT_EQ(length(4.9), "2 mm");
  EXPECT_EQ(length(1.4), "1 mm");
  EXPECT_EQ(length(130), "100 mm");
  EXPECT_EQ(length(0.03), "0.02 mm");
}

TEST(Annotations, OrientationLettersMarkPatientSides) {
  const PixelSize size{1000, 700};
  const Camera camera = camera_on({Vec3::Zero(), 20}, kPatientViews[0].direction_W, kPatientViews[0].up_W);
  std::string seen;
  for (const Annotation& letter : orientation_letters(camera, size)) {
    seen += letter.text;
    const Eigen::Vector2d aside = letter.text_centre_px - letter.lines[0].from;
    if (letter.text == "L") {
      EXPECT_GT(aside.x(), 40);
    }
    if (letter.text == "R") {
      EXPECT_LT(aside.x(), -40);
    }
    if (letter.text == "S") {
      EXPECT_LT(aside.y(), -40);
    }
  }
  EXPECT_EQ(seen, "LRSI");
}

}  // namespace
}  // namespace osteomill
