#include "osteomill/base/pose.h"

#include <cmath>
#include <limits>

namespace osteomill {

Vec3 rotation_vector(const Quat& rotation) noexcept {
  // q and -q are the same rotation; the one with w >= 0 has the smaller angle.
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const Vec3 half_sine = sign * rotation.vec();
  const double sine = half_sine.norm();
  if (sine < 1e-12) return 2.0 * half_sine;
  return 2.0 * std::atan2(sine, sign * rotation.w()) / sine * half_sine;
}

Quat quaternion_from_rotation_vector(const Vec3& rotation_vector) noexcept {
  const double angle = rotation_vector.norm();
  // sin(a/2)/a tends to 1/2.
  const double scale = angle < 1e-12 ? 0.5 : std::sin(0.5 * angle) / angle;
  Quat rotation;
  rotation.w() = std::cos(0.5 * angle);
  rotation.vec() = scale * rotation_vector;
  return rotation.normalized();
}

Quat smallest_rotation(const Vec3& from, const Vec3& to) noexcept {
  return Quat::FromTwoVectors(from, to);
}

Quat rotation_of(const Mat3& matrix) noexcept {
  constexpr double kTolerance = 0.01;
  const bool is_rotation =
      (matrix.transpose() * matrix - Mat3::Identity()).norm() <= kTolerance && matrix.determinant() > 0;
  if (is_rotation) return Quat(matrix).normalized();
  return Quat(Eigen::Vector4d::Constant(std::numeric_limits<double>::quiet_NaN()));
}

bool is_finite(const Pose& pose) noexcept {
  return pose.position_mm.allFinite() && pose.orientation.coeffs().allFinite();
}

}  // namespace osteomill
