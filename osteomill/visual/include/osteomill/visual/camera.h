#pragma once

#include <array>
#include <string_view>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Picture size, pixels.
struct PixelSize {
  int width = 0;
  int height = 0;
  friend bool operator==(const PixelSize&, const PixelSize&) = default;
};

/// Sphere in W, e.g. the bounds of a picture's content (camera_on()).
struct Sphere {
  Vec3 centre_W = Vec3::Zero();
  double radius_mm = 1;
  friend bool operator==(const Sphere&, const Sphere&) = default;
};

/// Perspective camera that looks at `focus_W`, the picture's centre, from a distance of `distance_mm`.
struct Camera {
  Vec3 focus_W = Vec3::Zero();
  double distance_mm = 100;
  /// Rotation from camera axes to W: x right, y up, z towards the viewer.
  Quat orientation = Quat::Identity();

  /// Vertical field of view. The narrower it is (and the farther the camera), the weaker the perspective.
  double field_of_view_rad = 0.52;

  Vec3 right_W() const { return orientation * Vec3::UnitX(); }
  Vec3 up_W() const { return orientation * Vec3::UnitY(); }
  Vec3 towards_viewer_W() const { return orientation * Vec3::UnitZ(); }
  Vec3 eye_W() const { return focus_W + distance_mm * towards_viewer_W(); }
  friend bool operator==(const Camera&, const Camera&) = default;
};

/// Returns a camera that looks along `direction_W` and shows the whole sphere, with `up_W` up in the picture.
/// `up_W` must not be parallel to `direction_W`.
Camera camera_on(const Sphere& sphere, const Vec3& direction_W, const Vec3& up_W);

/// Turns the camera about its focus, as mouse drags do in 3D Slicer: a drag across the whole window turns by
/// 200 degrees.
void turn(Camera& camera, const PixelSize& size, double right_px, double down_px);
/// Moves the camera so that the focus follows the pointer that drags it.
void pan(Camera& camera, const PixelSize& size, double right_px, double down_px);
/// Moves the camera closer for an upward drag (`down_px` < 0), away for a downward one.
void zoom_by_drag(Camera& camera, const PixelSize& size, double down_px);
/// Moves the camera closer by mouse-wheel steps; away if negative.
void zoom_by_wheel(Camera& camera, double steps);

/// Returns the size of a pixel, mm, at `depth_mm` from the eye along the view direction.
double mm_per_pixel(const Camera& camera, const PixelSize& size, double depth_mm);

/// Returns the point's distance from the eye along the view direction, mm.
double depth_of(const Camera& camera, const Vec3& point_W);

/// Returns the projection of a point, pixels from the top left; meaningless for points behind the eye.
Eigen::Vector2d pixel_of(const Camera& camera, const PixelSize& size, const Vec3& point_W);

/// Returns the unit direction from the eye through a pixel.
Vec3 ray_through(const Camera& camera, const PixelSize& size, double x_px, double y_px);

/// Returns the transform from W to camera axes, mm.
Eigen::Matrix4f view_matrix(const Camera& camera);
/// Returns the projection from camera axes to OpenGL clip coordinates, for depths from `near_mm` to `far_mm`.
Eigen::Matrix4f projection_matrix(const Camera& camera, const PixelSize& size, double near_mm, double far_mm);

/// A view along one of the patient's axes (W is LPS: +x left, +y posterior, +z superior).
struct PatientView {
  /// Side of the patient on which the viewer stands.
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
