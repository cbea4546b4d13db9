#pragma once

#include <array>
#include <string_view>

#include "osteomill/base/pose.h"

namespace osteomill {

struct PixelSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const PixelSize&, const PixelSize&) = default;
};

struct Sphere {
  Vec3 centre_W = Vec3::Zero();
  double radius_mm = 1;
  friend bool operator==(const Sphere&, const Sphere&) = default;
};

/// A perspective view: from `focus_W`, in the middle of the picture, back by `distance_mm`.
struct Camera {
  Vec3 focus_W = Vec3::Zero();
  double distance_mm = 100;
  /// The rotation from the camera's axes to W's: x to the right, y up, z towards the viewer.
  Quat orientation = Quat::Identity();

  /// The angle of view from bottom to top. The narrower it is (and the further away the camera), the less
  /// perspective there is.
  double field_of_view_rad = 0.52;

  Vec3 right_W() const { return orientation * Vec3::UnitX(); }
  Vec3 up_W() const { return orientation * Vec3::UnitY(); }
  Vec3 towards_viewer_W() const { return orientation * Vec3::UnitZ(); }
  Vec3 eye_W() const { return focus_W + distance_mm * towards_viewer_W(); }
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Looks along `direction_W` at all of the sphere, with `up_W` up in the picture (not along the direction).
Camera camera_on(const Sphere& sphere, const Vec3& direction_W, const Vec3& up_W);

/// Move the camera as 3D Slicer's views move under the mouse (pixels, y downwards). A drag across the window
/// turns by 200 degrees; what is dragged stays under the pointer at the focus when panning; zooming by a drag
/// upwards comes closer.
void turn(Camera& camera, const PixelSize& size, double right_px, double down_px);
void pan(Camera& camera, const PixelSize& size, double right_px, double down_px);
void zoom_by_drag(Camera& camera, const PixelSize& size, double down_px);
void zoom_by_wheel(Camera& camera, double steps);

/// Returns how wide a pixel is at this distance from the eye along the view.
double mm_per_pixel(const Camera& camera, const PixelSize& size, double depth_mm);

/// Returns the point's distance from the eye along the view.
double depth_of(const Camera& camera, const Vec3& point_W);

/// Returns where a point is seen, pixels from the top left; meaningless behind the eye.
Eigen::Vector2d pixel_of(const Camera& camera, const PixelSize& size, const Vec3& point_W);

/// Returns the unit direction from the eye through a pixel.
Vec3 ray_through(const Camera& camera, const PixelSize& size, double x_px, double y_px);

/// Return the matrices from world to camera, and from camera to OpenGL's clip coordinates with the depths
/// between `near_mm` and `far_mm`.
Eigen::Matrix4f view_matrix(const Camera& camera);
Eigen::Matrix4f projection_matrix(const Camera& camera, const PixelSize& size, double near_mm, double far_mm);

/// A view along the patient's axes (W is LPS: +x left, +y posterior, +z superior).
struct PatientView {
  /// The side on which the viewer is.
  std::string_view from;
  Vec3 direction_W;
  Vec3 up_W;
};
inline const std::array<PatientView, 6> kPatientViews{{{"anterior", Vec3::UnitY(), Vec3::UnitZ()},
                                                       {"posterior", -Vec3::UnitY(), Vec3::UnitZ()},
                                                       {"left", -Vec3::UnitX(), Vec3::UnitZ()},
                                                       {"right", Vec3::UnitX(), Vec3::UnitZ()},
                                                       {"superior", -Vec3::UnitZ(), -Vec3::UnitY()},
                                                       {"inferior", Vec3::UnitZ(), -Vec3::UnitY()}}};

}  // namespace osteomill
