#include "bone_points/energy_sum.h"

#include <Eigen/Geometry>

namespace osteomill {

namespace {

Mat3 cross(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

}  // namespace

EnergySum& EnergySum::operator+=(const EnergySum& other) {
  energy_Nmm += other.energy_Nmm;
  gradient += other.gradient;
  convex += other.convex;
  rest += other.rest;
  touching += other.touching;
  nearest_mm = std::min(nearest_mm, other.nearest_mm);
  return *this;
}

// Seen from the tool the point moves as exp(-t omega) (r - t delta): by v = -(delta + omega x r) at first,
// and with the acceleration omega x (omega x r) + 2 omega x delta. So d' = n.v and d'' = v.C v + n.a, with n
// and C the distance's derivatives; and E' = -p d', E'' = psi'' d'^2 - p d''.
void EnergySum::add_point(const Barrier::Value& push, const Vec3& point_T, const CoreDistance& distance) {
  nearest_mm = std::min(nearest_mm, distance.distance_mm);
  const double p = push.pressure;
  if (!(p > 0)) return;
  ++touching;
  const Vec3& n = distance.outward_T;
  Vector6 along;
  along << n, point_T.cross(n);
  Eigen::Matrix<double, 3, 6> motion;  // minus v, of delta and omega
  motion << Mat3::Identity(), -cross(point_T);
  energy_Nmm += push.energy;
  gradient += p * along;
  convex += push.stiffness * along * along.transpose();
  rest -= p * motion.transpose() * distance.curvature_per_mm * motion;
  const Mat3 symmetric = 0.5 * (n * point_T.transpose() + point_T * n.transpose());
  rest.bottomRightCorner<3, 3>() -= p * (symmetric - n.dot(point_T) * Mat3::Identity());
  rest.topRightCorner<3, 3>() -= p * cross(n);
  rest.bottomLeftCorner<3, 3>() += p * cross(n);
}

}  // namespace osteomill
