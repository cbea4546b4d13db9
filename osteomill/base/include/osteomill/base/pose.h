#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace osteomill {

/// A point, direction or force; the variable's name gives frame and unit (`point_W_mm`).
using Vec3 = Eigen::Vector3d;
/// A 3 x 3 matrix, such as a rotation or the axes of a grid.
using Mat3 = Eigen::Matrix3d;
/// A rotation `R_AB` from frame B to frame A, a unit quaternion.
using Quat = Eigen::Quaterniond;
static_assert(alignof(Quat) == 16,
              "osteomill is built with EIGEN_MAX_ALIGN_BYTES=16; programs that link it must be too");

/// A rigid transform `X_AB`, the pose of frame B in frame A: a point `p_B` in B is `X_AB * p_B` in A, and
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
  /// Returns whether both are equal to the last bit.
  friend bool operator==(const Pose& a, const Pose& b) {
    return a.position_mm == b.position_mm && a.orientation.coeffs() == b.orientation.coeffs();
  }
};

/// Returns the rotation vector (axis times angle, rad, angle at most pi) of a unit quaternion.
Vec3 rotation_vector(const Quat& rotation) noexcept;

/// Returns the unit quaternion of a rotation vector (axis times angle, rad); the inverse of
/// `rotation_vector(rotation)`.
Quat quaternion_from_rotation_vector(const Vec3& rotation_vector) noexcept;

/// Returns the smallest rotation that maps the direction of `from` to that of `to` (neither may be zero).
Quat smallest_rotation(const Vec3& from, const Vec3& to) noexcept;

/// Returns the rotation that a matrix represents within a tolerance of 0.01; a non-finite quaternion if it
/// does not represent one.
Quat rotation_of(const Mat3& matrix) noexcept;

/// Returns the shaft direction of the tool or device in the outer frame: the pose's +z axis.
inline Vec3 shaft_direction(const Pose& X_WT) noexcept {
  return X_WT.orientation * Vec3::UnitZ();
}

/// Returns whether all components are finite.
bool is_finite(const Pose& pose) noexcept;

/// The velocity of a frame: linear velocity of its origin, mm/s, and angular velocity, rad/s, both in the
/// outer frame.
struct Twist {
  Vec3 linear_mm_s = Vec3::Zero();
  Vec3 angular_rad_s = Vec3::Zero();
};

}  // namespace osteomill
