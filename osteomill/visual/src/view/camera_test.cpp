#include "osteomill/visual/camera.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

constexpr PixelSize kSize{800, 600};
const Sphere kSphere{{3, -2, 7}, 10};

Eigen::Vector2d by_matrices(const Camera& camera, const Vec3& point_W) {
  const Eigen::Vector4f clip =
      projection_matrix(camera, kSize, 1, 1000) * view_matrix(camera) * point_W.cast<float>().homogeneous();
  const Eigen::Vector4d seen = (clip / clip.w()).cast<double>();
  return {0.5 * kSize.width * (1 + seen.x()), 0.5 * kSize.height * (1 - seen.y())};
}

TEST(Camera, PixelsRaysAndMatricesAgree) {
  Camera camera = camera_on(kSphere, {1, 2, -0.5}, {0, 0, 1});
  turn(camera, kSize, 37, -81);
  pan(camera, kSize, 12, 5);
  for (const Vec3& offset : {Vec3(0, 0, 0), Vec3(4, 1, -2), Vec3(-3, 5, 6)}) {
    const Vec3 point_W = kSphere.centre_W + offset;
    const Eigen::Vector2d pixel = pixel_of(camera, kSize, point_W);
    EXPECT_NEAR((pixel - by_matrices(camera, point_W)).norm(), 0, 1e-2);
    const Vec3 ray = ray_through(camera, kSize, pixel.x(), pixel.y());
    EXPECT_NEAR(ray.cross((point_W - camera.eye_W()).normalized()).norm(), 0, 1e-9);
  }
}

TEST(Camera, FitsWholeSphereInView) {
  const Camera camera = camera_on(kSphere, {0, 1, 0}, {0, 0, 1});
  EXPECT_NEAR((pixel_of(camera, kSize, kSphere.centre_W) - Eigen::Vector2d(400, 300)).norm(), 0, 1e-9);
  // The tangent to the sphere from above passes through the picture's upper border.
  const Vec3 border = ray_through(camera, kSize, 400, 0);
  const Vec3 to_centre = kSphere.centre_W - camera.eye_W();
  EXPECT_NEAR(border.cross(to_centre).norm(), kSphere.radius_mm, 1e-9);
}

TEST(Camera, PatientViewsShowTheNamedSide) {
  // Facing the patient: the patient's left is on the right of the picture, the head up.
  const Camera front = camera_on(kSphere, kPatientViews[0].direction_W, kPatientViews[0].up_W);
  EXPECT_GT(front.right_W().x(), 0.99);
  EXPECT_GT(front.up_W().z(), 0.99);
  const Camera above = camera_on(kSphere, kPatientViews[4].direction_W, kPatientViews[4].up_W);
  EXPECT_GT(above.towards_viewer_W().z(), 0.99);
  const Camera left = camera_on(kSphere, kPatientViews[2].direction_W, kPatientViews[2].up_W);
  EXPECT_GT(left.towards_viewer_W().x(), 0.99);
  EXPECT_GT(left.up_W().z(), 0.99);
}

TEST(Camera, DraggedPointsFollowThePointer) {
  Camera camera = camera_on(kSphere, {1, 0, 0}, {0, 0, 1});
  const Vec3 point_W = camera.focus_W;
  pan(camera, kSize, 25, -40);
  EXPECT_NEAR((pixel_of(camera, kSize, point_W) - Eigen::Vector2d(425, 260)).norm(), 0, 1e-6);
  const Vec3 front_W = camera.focus_W + 5 * camera.towards_viewer_W();
  const Eigen::Vector2d before = pixel_of(camera, kSize, front_W);
  turn(camera, kSize, 10, 20);
  const Eigen::Vector2d after = pixel_of(camera, kSize, front_W);
  EXPECT_GT(after.x(), before.x());
  EXPECT_GT(after.y(), before.y());
}

TEST(Camera, ZoomApproachesWithoutPassingFocus) {
  Camera camera = camera_on(kSphere, {1, 0, 0}, {0, 0, 1});
  const double before_mm = camera.distance_mm;
  zoom_by_drag(camera, kSize, -30);
  EXPECT_NEAR(camera.distance_mm, before_mm / 1.1, 1e-9);
  zoom_by_wheel(camera, 1);
  EXPECT_NEAR(camera.distance_mm, before_mm / 1.1 / 1.21, 1e-9);
  zoom_by_wheel(camera, 1000);
  EXPECT_GT(camera.distance_mm, 0);
}

}  // namespace
}  // namespace osteomill
