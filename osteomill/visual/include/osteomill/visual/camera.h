#pragma once

#include <array>
#include <string_view>

#include "osteomill/base/pose.h"

namespace osteomill {

/// The size of a picture in pixels.
struct PixelSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const PixelSize&, const PixelSize&) = default;
};

/// A ball in W, as around all that a picture shows (camera_on()).
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

/// Returns a camera that looks along `direction_W` at all of the sphere, with `up_W` up in the picture (not
/// along the direction).
Camera camera_on(const Sphere& sphere, const Vec3& direction_W, const Vec3& up_W);

/// Turns the camera about its focus, as 3D Slicer's views turn under the mouse: a drag by `right_px` and
/// `down_px`, as wide as the window, turns by 200 degrees.
void turn(Camera& camera, const PixelSize& size, double right_px, double down_px);
/// Moves the camera so that the focus stays under the pointer that drags it.
void pan(Camera& camera, const PixelSize& size, double right_px, double down_px);
/// Brings the camera closer by a drag upwards (`down_px` below 0), or away by one downwards.
void zoom_by_drag(Camera& camera, const PixelSize& size, double down_px);
/// Brings the camera closer by steps of the mouse's wheel, or away by steps below 0.
void zoom_by_wheel(Camera& camera, double steps);

/// Returns how wide a pixel is, in mm, at this distance from the eye along the view.
double mm_per_pixel(const Camera& camera, const PixelSize& size, double depth_mm);

/// Returns the point's distance from the eye along the view, mm.
double depth_of(const Camera& camera, const Vec3& point_W);

/// Returns where a point is seen, pixels from the top left; meaningless behind the eye.
Eigen::Vector2d pixel_of(const Camera& camera, const PixelSize& size, const Vec3& point_W);

/// Returns the unit direction from the eye through a pixel.
Vec3 ray_through(const Camera& camera, const PixelSize& size, double x_px, double y_px);

/// Returns the matrix from W to the camera's axes, mm.
Eigen::Matrix4f view_matrix(const Camera& camera);
/// Returns the matrix from the camera's axes to OpenGL's clip coordinates, for depths between `near_mm` and
/// `far_mm`.
Eigen::Matrix4f projection_matrix(const Camera& camera, const PixelSize& size, double near_mm, double far_mm);

/// A view along one of the patient's axes (W is LPS: +x left, +y posterior, +z superior); kPatientViews has
/// all.
struct PatientView {
  /// The side on which the viewer is.
  std::string_view from;
  Vec3 direction_W;
  Vec3 up_W;
};
/// The six views along the patient's axes.
inline const std::array<PatientView, 6> kPatientViews{{{"anterior", Vec3::UnitY(), Vec3::UnitZ()},
                                                       {"posterior", -Vec3::UnitY(), Vec3::UnitZ()},
                                                       {"left", -Vec3::UnitX(), Vec3::UnitZ()},
                                                       {"right", Vec3::UnitX(), Vec3::UnitZ()},
                                                       {"superior", -Vec3::UnitZ(), -Vec3::UnitY()},
                                                       {"inferior", Vec3::UnitZ(), -Vec3::UnitY()}}};

}  // namespace osteomill
