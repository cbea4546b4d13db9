#include "bone_points/near_points.h"

#include <algorithm>
#include <span>

#include "bone_points/brick_points.h"
#include "bone_points/near_kernel.h"

namespace osteomill {

namespace {

using Lanes = float[NearPoints::kLanes];

double lane_sum(const Lanes& lanes) {
  double sum = 0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}
double lane_min(const Lanes& lanes) {
  return static_cast<double>(*std::min_element(std::begin(lanes), std::end(lanes)));
}

Vec3 place(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& z,
           std::size_t n) {
  return {static_cast<double>(x[n]), static_cast<double>(y[n]), static_cast<double>(z[n])};
}

// n = (u, v, 0) and r = rho n + z e_z, so that r x n = z (-v, u, 0): see EnergySum::add_point for the terms.
EnergySum side_sum(const SideLanes& lanes) {
  double s[SideLanes::kSums];
  for (int n = 0; n < SideLanes::kSums; ++n) s[n] = lane_sum(lanes.sums[n]);
  EnergySum sum;
  sum.energy_Nmm = s[13];
  sum.gradient << s[0], s[1], 0, -s[3], s[2], 0;
  // m n n^T and q (I - e_z e_z^T), times 1, z and z^2.
  const double m[3][3] = {{s[4], s[5], s[6]}, {s[7], s[8], s[9]}, {s[10], s[11], s[12]}};
  const double* q = &s[14];
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
  // What turns the side's tangent about the axis: r x t = (-z u, -z v, rho), t = (-v, u, 0).
  const double pu = s[0], pv = s[1], pzu = s[2], pzv = s[3];
  const double rho_uu = s[17], rho_uv = s[18], rho_vv = s[19], rho = rho_uu + rho_vv;
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
  sum.nearest_mm = lane_min(lanes.nearest);
  return sum;
}

// r x n = 0; q (I - n n^T) and m n n^T.
EnergySum ball_sum(const BallLanes& lanes) {
  double s[BallLanes::kSums];
  for (int n = 0; n < BallLanes::kSums; ++n) s[n] = lane_sum(lanes.sums[n]);
  EnergySum sum;
  sum.energy_Nmm = s[9];
  sum.gradient.head<3>() << s[0], s[1], s[2];
  sum.convex.topLeftCorner<3, 3>() << s[3], s[4], s[5], s[4], s[6], s[7], s[5], s[7], s[8];
  sum.rest.topLeftCorner<3, 3>().diagonal().setConstant(-s[10]);
  sum.touching = lanes.touching;
  sum.nearest_mm = lane_min(lanes.nearest);
  return sum;
}

}  // namespace

NearPoints::NearPoints(std::size_t capacity) {
  for (std::vector<float>* row :
       {&gathered_x, &gathered_y, &gathered_z, &area, &x, &y, &z, &distance, &out_x, &out_y, &out_z}) {
    row->resize(capacity);
  }
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

void close_gathering(NearPoints& near) noexcept {
  while (near.count % NearPoints::kLanes != 0) {
    near.gathered_x[near.count] = PointChunk::kFarAway_mm;
    near.gathered_y[near.count] = near.gathered_z[near.count] = near.area[near.count] = 0;
    ++near.count;
  }
}

EnergySum ball_energy(NearPoints& near, const Frame& moved, const Cores& cores,
                      const Barrier& barrier) noexcept {
  BallLanes lanes;
  std::fill(std::begin(lanes.nearest), std::end(lanes.nearest), PointChunk::kFarAway_mm);
  sum_ball(near, moved, cores, barrier, lanes);
  return ball_sum(lanes);
}

EnergySum cylinder_energy(NearPoints& near, const Frame& moved, const Cores& cores,
                          const Barrier& barrier) noexcept {
  SideLanes lanes;
  std::fill(std::begin(lanes.nearest), std::end(lanes.nearest), PointChunk::kFarAway_mm);
  sum_side(near, moved, cores, barrier, lanes);
  EnergySum sum = side_sum(lanes);
  // Their order must not depend on the width of the registers.
  const std::span at_end(near.at_end.data(), near.at_end_count);
  std::sort(at_end.begin(), at_end.end());
  for (const std::uint32_t n : at_end) {
    const Vec3 point_T = place(near.x, near.y, near.z, n);
    const CoreDistance distance = distance_to_cylinder(cores, point_T);
    sum.add_point(static_cast<double>(near.area[n]) * barrier.at(distance.distance_mm), point_T, distance);
    near.distance[n] = static_cast<float>(distance.distance_mm);
    near.out_x[n] = static_cast<float>(distance.outward_T.x());
    near.out_y[n] = static_cast<float>(distance.outward_T.y());
    near.out_z[n] = static_cast<float>(distance.outward_T.z());
  }
  return sum;
}

}  // namespace osteomill
