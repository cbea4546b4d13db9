#include "osteomill/visual/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace osteomill {

namespace {

// VTK's trackball style, as in 3D Slicer's views.
constexpr double kTurnAcross_rad = 200.0 / 180.0 * std::numbers::pi;
constexpr double kZoomBase = 1.1;
constexpr double kZoomAcrossHalf = 10.0;
constexpr double kZoomPerWheelStep = 2.0;
constexpr double kMinDistance_mm = 2.0;
constexpr double kMaxDistance_mm = 5000.0;

double half_height_per_depth(const Camera& camera) {
  return std::tan(0.5 * camera.field_of_view_rad);
}

void scale_distance(Camera& camera, double factor) {
  camera.distance_mm = std::clamp(camera.distance_mm / factor, kMinDistance_mm, kMaxDistance_mm);
}

Vec3 in_camera(const Camera& camera, const Vec3& point_W) {
  return camera.orientation.conjugate() * (point_W - camera.eye_W());
}

}  // namespace

Camera camera_on(const Sphere& sphere, const Vec3& direction_W, const Vec3& up_W) {
  const Vec3 back = -direction_W.normalized();
  const Vec3 right = up_W.cross(back).normalized();
  Mat3 axes;
  axes << right, back.cross(right), back;
  Camera camera;
  camera.focus_W = sphere.centre_W;
  camera.orientation = Quat(axes).normalized();
  camera.distance_mm = sphere.radius_mm / std::sin(0.5 * camera.field_of_view_rad);
  return camera;
}

void turn(Camera& camera, const PixelSize& size, double right_px, double down_px) {
  const double about_up = -right_px / size.width * kTurnAcross_rad;
  const double about_right = -down_px / size.height * kTurnAcross_rad;
  const Quat turned = camera.orientation * quaternion_from_rotation_vector({about_right, about_up, 0});
  camera.orientation = turned.normalized();
}

void pan(Camera& camera, const PixelSize& size, double right_px, double down_px) {
  const double scale = mm_per_pixel(camera, size, camera.distance_mm);
  camera.focus_W += scale * (down_px * camera.up_W() - right_px * camera.right_W());
}

void zoom_by_drag(Camera& camera, const PixelSize& size, double down_px) {
  scale_distance(camera, std::pow(kZoomBase, -kZoomAcrossHalf * down_px / (0.5 * size.height)));
}

void zoom_by_wheel(Camera& camera, double steps) {
  scale_distance(camera, std::pow(kZoomBase, kZoomPerWheelStep * steps));
}

double mm_per_pixel(const Camera& camera, const PixelSize& size, double depth_mm) {
  return 2 * depth_mm * half_height_per_depth(camera) / size.height;
}

double depth_of(const Camera& camera, const Vec3& point_W) {
  return -in_camera(camera, point_W).z();
}

Eigen::Vector2d pixel_of(const Camera& camera, const PixelSize& size, const Vec3& point_W) {
  const Vec3 point = in_camera(camera, point_W);
  const double scale = mm_per_pixel(camera, size, -point.z());
  return {0.5 * size.width + point.x() / scale, 0.5 * size.height - point.y() / scale};
}

Vec3 ray_through(const Camera& camera, const PixelSize& size, double x_px, double y_px) {
  const double scale = mm_per_pixel(camera, size, 1.0);
  const Vec3 ray((x_px - 0.5 * size.width) * scale, (0.5 * size.height - y_px) * scale, -1);
  return (camera.orientation * ray).normalized();
}

Eigen::Matrix4f view_matrix(const Camera& camera) {
  const Mat3 rotation = camera.orientation.conjugate().toRotationMatrix();
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Identity();
  matrix.topLeftCorner<3, 3>() = rotation.cast<float>();
  matrix.topRightCorner<3, 1>() = (-(rotation * camera.eye_W())).cast<float>();
  return matrix;
}

Eigen::Matrix4f projection_matrix(const Camera& camera, const PixelSize& size, double near_mm,
                                  double far_mm) {
  const double up = 1 / half_height_per_depth(camera);
  Eigen::Matrix4f matrix = Eigen::Matrix4f::Zero();
  matrix(0, 0) = static_cast<float>(up * size.height / size.width);
  matrix(1, 1) = static_cast<float>(up);
  matrix(2, 2) = static_cast<float>(-(far_mm + near_mm) / (far_mm - near_mm));
  matrix(2, 3) = static_cast<float>(-2 * far_mm * near_mm / (far_mm - near_mm));
  matrix(3, 2) = -1;
  return matrix;
}

}  // namespace osteomill
