#include "barrier_shell/near_points.h"

#include <algorithm>
#include <span>

#include <Eigen/Geometry>

#include "barrier_shell/near_kernel.h"
#include "bone_points/brick_points.h"

namespace osteomill::barrier_shell {

namespace {

Mat3 cross(const Vec3& v) {
  Mat3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Vec3 position_of(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
                 std::size_t n) {
  return {static_cast<double>(x[n]), static_cast<double>(y[n]), static_cast<double>(z[n])};
}

// n = (u, v, 0) and r = rho n + z e_z, so that r x n = z (-v, u, 0): see add_point for the terms.
EnergySum side_sum(const Lanes<SideSum>& lanes) {
  using S = SideSum;
  const auto total = [&](SideSum sum) { return lanes.total(sum); };
  const double pu = total(S::pu), pv = total(S::pv), pzu = total(S::pzu), pzv = total(S::pzv);
  EnergySum sum;
  sum.energy_Nmm = total(S::energy);
  sum.gradient << pu, pv, 0, -pzv, pzu, 0;
  // m n n^T and q (I - e_z e_z^T), times 1, z and z^2.
  const double m[3][3] = {{total(S::muu), total(S::muv), total(S::mvv)},
                          {total(S::mzuu), total(S::mzuv), total(S::mzvv)},
                          {total(S::mzzuu), total(S::mzzuv), total(S::mzzvv)}};
  const double q[3] = {total(S::q), total(S::qz), total(S::qzz)};
  // In the order of delta_x, delta_y, omega_x, omega_y: the point's move is (dx + z wy - .., dy - z wx + ..).
  const int at[4] = {0, 1, 4, 3};
  const double sign[4] = {1, 1, 1, -1};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const int power = row / 2 + column / 2, axes = row % 2 + column % 2;
      const double both = sign[row] * sign[column];
      sum.convex(at[row], at[column]) = both * m[power][axes];
      if (row % 2 == column % 2) sum.rest(at[row], at[column]) = -both * q[power];
    }
  }
  // Terms from rotating the side's tangent about the axis: r x t = (-z u, -z v, rho), t = (-v, u, 0).
  const double rho_uu = total(S::p_rho_uu), rho_uv = total(S::p_rho_uv), rho_vv = total(S::p_rho_vv);
  const double rho = rho_uu + rho_vv;
  const auto add = [&](int row, int column, double value) {
    sum.rest(row, column) += value;
    if (row != column) sum.rest(column, row) += value;
  };
  add(0, 5, pv);
  add(1, 5, -pu);
  add(3, 5, pzu);
  add(4, 5, pzv);
  add(5, 5, -rho);
  // -p times the symmetric part of n r^T - (n.r) I.
  add(3, 3, rho_vv);
  add(4, 4, rho_uu);
  add(5, 5, rho);
  add(3, 4, -rho_uv);
  add(3, 5, -0.5 * pzu);
  add(4, 5, -0.5 * pzv);
  // -p [n]x.
  add(0, 5, -pv);
  add(1, 5, pu);
  add(2, 3, pv);
  add(2, 4, -pu);
  sum.touching = lanes.touching;
  sum.nearest_mm = lanes.nearest_mm();
  return sum;
}

// r x n = 0; q (I - n n^T) and m n n^T.
EnergySum ball_sum(const Lanes<BallSum>& lanes) {
  using S = BallSum;
  const auto total = [&](BallSum sum) { return lanes.total(sum); };
  EnergySum sum;
  sum.energy_Nmm = total(S::energy);
  sum.gradient.head<3>() << total(S::px), total(S::py), total(S::pz);
  const double mxy = total(S::mxy), mxz = total(S::mxz), myz = total(S::myz);
  sum.convex.topLeftCorner<3, 3>() << total(S::mxx), mxy, mxz, mxy, total(S::myy), myz, mxz, myz,
      total(S::mzz);
  sum.rest.topLeftCorner<3, 3>().diagonal().setConstant(-total(S::q));
  sum.touching = lanes.touching;
  sum.nearest_mm = lanes.nearest_mm();
  return sum;
}

}  // namespace

// In T the point moves as exp(-t omega) (r - t delta), with initial velocity v = -(delta + omega x r) and
// acceleration a = omega x (omega x r) + 2 omega x delta. So d' = n.v and d'' = v.C v + n.a, where n and C
// are the distance's derivatives, and E' = -p d', E'' = psi'' d'^2 - p d''.
void add_point(EnergySum& sum, const Barrier::Value& push, const Vec3& point_T,
               const CoreDistance& distance) {
  sum.nearest_mm = std::min(sum.nearest_mm, distance.distance_mm);
  const double p = push.pressure;
  if (!(p > 0)) return;
  ++sum.touching;
  const Vec3& n = distance.outward_T;
  Vector6 along;
  along << n, point_T.cross(n);
  Eigen::Matrix<double, 3, 6> motion;  // maps [delta; omega] to -v
  motion << Mat3::Identity(), -cross(point_T);
  sum.energy_Nmm += push.energy;
  sum.gradient += p * along;
  sum.convex += push.stiffness * along * along.transpose();
  sum.rest -= p * motion.transpose() * distance.curvature_per_mm * motion;
  const Mat3 symmetric = 0.5 * (n * point_T.transpose() + point_T * n.transpose());
  sum.rest.bottomRightCorner<3, 3>() -= p * (symmetric - n.dot(point_T) * Mat3::Identity());
  sum.rest.topRightCorner<3, 3>() -= p * cross(n);
  sum.rest.bottomLeftCorner<3, 3>() += p * cross(n);
}

NearPoints::NearPoints(std::size_t capacity) {
  for (std::vector<float>* row : {&x, &y, &z, &area}) row->resize(capacity);
}

MeasuredPoints::MeasuredPoints(std::size_t capacity) {
  for (std::vector<float>* row : {&distance, &out_x, &out_y, &out_z, &x, &y, &z}) row->resize(capacity);
  at_end.resize(capacity);
}

Frame frame_of(const Mat3& turn, const Vec3& origin_mm) noexcept {
  Frame frame;
  for (int row = 0; row < 3; ++row) {
    frame.origin[row] = static_cast<float>(origin_mm[row]);
    for (int column = 0; column < 3; ++column) {
      frame.turn[row][column] = static_cast<float>(turn(row, column));
    }
  }
  return frame;
}

void pad_last_lanes(NearPoints& near) noexcept {
  while (near.count % NearPoints::kLanes != 0) {
    near.x[near.count] = PointChunk::kFarAway_mm;
    near.y[near.count] = near.z[near.count] = near.area[near.count] = 0;
    ++near.count;
  }
}

void measure_ball(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
                  MeasuredPoints& measured) noexcept {
  Lanes<BallSum> lanes;
  sum_ball(near, moved, cores, barrier, lanes, measured);
  measured.sum = ball_sum(lanes);
}

void measure_cylinder(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
                      MeasuredPoints& measured) noexcept {
  Lanes<SideSum> lanes;
  sum_side(near, moved, cores, barrier, lanes, measured);
  measured.sum = side_sum(lanes);
  // The order must not depend on the register width.
  const std::span at_end(measured.at_end.data(), measured.at_end_count);
  std::sort(at_end.begin(), at_end.end());
  for (const std::uint32_t n : at_end) {
    const Vec3 point_T = position_of(measured.x, measured.y, measured.z, n);
    const CoreDistance distance = distance_to_cylinder(cores, point_T);
    add_point(measured.sum, static_cast<double>(near.area[n]) * barrier.at(distance.distance_mm), point_T,
              distance);
    measured.distance[n] = static_cast<float>(distance.distance_mm);
    measured.out_x[n] = static_cast<float>(distance.outward_T.x());
    measured.out_y[n] = static_cast<float>(distance.outward_T.y());
    measured.out_z[n] = static_cast<float>(distance.outward_T.z());
  }
}

}  // namespace osteomill::barrier_shell
