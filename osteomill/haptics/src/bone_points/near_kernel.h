#pragma once

#include "bone_points/brick_points.h"
#include "bone_points/near_points.h"

namespace osteomill {

/// The tool's parts as the kernels read them.
struct KernelShape {
  float ball_radius, cylinder_radius, cylinder_length;
};

/// How far from a part points are gathered: `near_mm` + `per_lever` times their distance from the burr's
/// centre.
struct Reach {
  double near_mm = 0;
  double per_lever = 0;
};

/// Appends the points of a brick that are within reach of the part; `frame` is the brick's, seen from the
/// tool. The widest vector instructions that the processor has are chosen when first called; they give the
/// same bits as the narrowest, as do those of all that follows. Safe in the haptic tick.
void gather_near_ball(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                      const Cores& cores, const Reach& reach, NearPoints& near) noexcept;
void gather_near_cylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                          const Cores& cores, const Reach& reach, NearPoints& near) noexcept;

/// Sums over points in `NearPoints::kLanes` lanes each. Points on the ball: p n (3) and m n n^T (xx, xy, xz,
/// yy, yz, zz), E and q, with p the push, q = p / r and m = psi'' + q.
struct BallLanes {
  static constexpr int kSums = 11;
  alignas(64) float sums[kSums][NearPoints::kLanes] = {};
  alignas(64) float nearest[NearPoints::kLanes] = {};
  int touching = 0;
};
/// Points on the cylinder's side, n = (u, v, 0): p (u, v) and z p (u, v); m (uu, uv, vv) times 1, z, z^2; E;
/// q = p / rho times 1, z, z^2; p rho (uu, uv, vv), with m = psi'' + q.
struct SideLanes {
  static constexpr int kSums = 20;
  alignas(64) float sums[kSums][NearPoints::kLanes] = {};
  alignas(64) float nearest[NearPoints::kLanes] = {};
  int touching = 0;
};

/// Of points gathered by a tool whose frame then is `moved` seen from now.
void sum_ball(NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              BallLanes& lanes) noexcept;
/// Points at the ends are listed in `near.at_end` and left out.
void sum_side(NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              SideLanes& lanes) noexcept;

/// The greatest `distance_used / distance` of a move, at the distances of the last sum, of which none counts
/// as less than `min_distance_mm`; at least 0.
double max_use_by_ball(const NearPoints& near, const MoveT& move, double min_distance_mm) noexcept;
double max_use_by_cylinder(const NearPoints& near, const MoveT& move, double min_distance_mm) noexcept;

/// The sets of vector instructions that this was compiled for, as bits of hwy/targets.h.
std::int64_t near_kernel_targets();

}  // namespace osteomill
