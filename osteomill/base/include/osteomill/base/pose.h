#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace osteomill {

/// A point, a direction or a vector of forces; the name says in which frame and unit (`point_W_mm`).
using Vec3 = Eigen::Vector3d;
/// A 3 x 3 matrix, as of a rotation or of a grid's axes.
using Mat3 = Eigen::Matrix3d;
/// A rotation `R_AB` from frame B to frame A, a unit quaternion.
using Quat = Eigen::Quaterniond;
static_assert(alignof(Quat) == 16,
              "osteomill is built with EIGEN_MAX_ALIGN_BYTES=16; so must be what links it");

/// A rigid placement `X_AB` of frame B in frame A: a point `p_B` of B lies at `X_AB * p_B` in A, and
/// `X_AB * X_BC` is `X_AC`. Position in mm; `orientation` is a unit quaternion. Safe in the haptic tick.
struct Pose {
  Vec3 position_mm = Vec3::Zero();
  Quat orientation = Quat::Identity();

  Vec3 operator*(const Vec3& point_mm) const { return orientation * point_mm + position_mm; }
  Pose operator*(const Pose& inner) const {
    return {*this * inner.position_mm, (orientation * inner.orientation).normalized()};
  }
  Pose inverse() const noexcept {
    const Quat back = orientation.conjugate();
    return {-(back * position_mm), back};
  }
  /// Returns whether both are the same to the last bit.
  friend bool operator==(const Pose& a, const Pose& b) {
    return a.position_mm == b.position_mm && a.orientation.coeffs() == b.orientation.coeffs();
  }
};

/// Returns the rotation vector (axis times angle, rad, angle at most pi) of a unit quaternion.
Vec3 rotation_vector(const Quat& rotation) noexcept;

/// Returns the unit quaternion that turns by `rotation_vector` (axis times angle, rad); the inverse of
/// `rotation_vector(rotation)`.
Quat quaternion_from_rotation_vector(const Vec3& rotation_vector) noexcept;

/// Returns the smallest rotation that turns the direction of `from` into that of `to` (neither of them zero).
Quat smallest_rotation(const Vec3& from, const Vec3& to) noexcept;

/// Returns the rotation that a matrix represents within 0.01; a quaternion that is not finite if it
/// represents none.
Quat rotation_of(const Mat3& matrix) noexcept;

/// Returns the tool's or device's shaft direction in the outer frame: the direction of the pose's +z axis.
inline Vec3 shaft_direction(const Pose& X_WT) noexcept {
  return X_WT.orientation * Vec3::UnitZ();
}

/// Returns whether every number of the pose is finite.
bool is_finite(const Pose& pose) noexcept;

/// The velocity of a frame: of its origin in mm/s, and its angular velocity in rad/s, both in the outer
/// frame.
struct Twist {
  Vec3 linear_mm_s = Vec3::Zero();
  Vec3 angular_rad_s = Vec3::Zero();
};

}  // namespace osteomill
