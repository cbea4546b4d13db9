#pragma once

#include "osteomill/haptics/barrier_shell/near_points.h"

namespace osteomill::barrier_shell {

/// What the kernels read of cores and barrier.
struct KernelShape {
  float ball_radius;
  float cylinder_radius;
  float cylinder_length;
  float width;
  float pressure;
};

/// Sums over points in `NearPoints::kLanes` lanes each. Points on the ball: E, p n (3), m n n^T (xx, xy, xz,
/// yy, yz, zz) and q, with q = p / r and m = psi'' + q.
struct BallLanes {
  static constexpr int kSums = 11;
  alignas(64) float sums[kSums][NearPoints::kLanes] = {};
  alignas(64) float nearest[NearPoints::kLanes] = {};
  int touching = 0;
};
/// Points on the cylinder's side, n = (u, v, 0), q = p / rho, m = psi'' + q: E; p (u, v) and z p (u, v); m
/// (uu, uv, vv) times 1, z, z^2; q times 1, z, z^2; p rho (uu, uv, vv).
struct SideLanes {
  static constexpr int kSums = 20;
  alignas(64) float sums[kSums][NearPoints::kLanes] = {};
  alignas(64) float nearest[NearPoints::kLanes] = {};
  int touching = 0;
};

void sum_ball(NearPoints& near, const Frame& moved, const KernelShape& shape, BallLanes& lanes);
/// Points beyond the ends are listed in `near.beyond_end` and left out.
void sum_side(NearPoints& near, const Frame& moved, const KernelShape& shape, SideLanes& lanes);

}  // namespace osteomill::barrier_shell
