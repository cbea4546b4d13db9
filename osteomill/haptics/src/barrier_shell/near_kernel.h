#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "barrier_shell/near_points.h"
#include "bone_points/brick_points.h"

namespace osteomill::barrier_shell {

/// The region in which points are gathered: within `near_mm` of a core or, at the cylinder, within `near_mm`
/// + `per_lever` times their distance from the burr's centre.
struct GatherRegion {
  Cores cores;
  double near_mm = 0;
  double per_lever = 0;
};

/// Appends the points of a brick that lie in the part's region; `frame` is the brick's, seen from the
/// tool. The first call chooses the widest vector instructions that the processor has; they give the same
/// bits as the narrowest. That holds for all functions below too. Safe in the haptic tick.
void gather_near_ball(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                      const GatherRegion& region, NearPoints& near) noexcept;
void gather_near_cylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                          const GatherRegion& region, NearPoints& near) noexcept;

/// Names the sums over points on the ball. With n the direction out of it, p the push, q = p / r and
/// m = psi'' + q: energy, q, p n and m n n^T.
enum class BallSum { energy, q, px, py, pz, mxx, mxy, mxz, myy, myz, mzz, count };
/// Names the sums over points on the cylinder's side. With n = (u, v, 0), p the push, q = p / rho and
/// m = psi'' + q: energy, and q, p n, m n n^T and p rho n n^T times powers of z as named.
enum class SideSum {
  energy,
  q,
  qz,
  qzz,
  pu,
  pv,
  pzu,
  pzv,
  muu,
  muv,
  mvv,
  mzuu,
  mzuv,
  mzvv,
  mzzuu,
  mzzuv,
  mzzvv,
  p_rho_uu,
  p_rho_uv,
  p_rho_vv,
  count
};

/// Sums over points in `NearPoints::kLanes` lanes each, named by BallSum or SideSum.
template <typename Name>
struct Lanes {
  static constexpr std::size_t kSums = static_cast<std::size_t>(Name::count);
  alignas(64) float sums[kSums][NearPoints::kLanes] = {};
  alignas(64) float nearest[NearPoints::kLanes];
  int touching = 0;

  Lanes() { std::fill(std::begin(nearest), std::end(nearest), PointChunk::kFarAway_mm); }
  double total(Name name) const {
    double sum = 0;
    for (const float lane : sums[static_cast<std::size_t>(name)]) sum += static_cast<double>(lane);
    return sum;
  }
  double nearest_mm() const {
    return static_cast<double>(*std::min_element(std::begin(nearest), std::end(nearest)));
  }
};

/// Sums over points and measures each, as measure_ball and measure_cylinder do. Points at the cylinder's ends
/// are listed in `measured.at_end` and left out of the sums.
void sum_ball(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              Lanes<BallSum>& lanes, MeasuredPoints& measured) noexcept;
void sum_side(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              Lanes<SideSum>& lanes, MeasuredPoints& measured) noexcept;

/// Returns the greatest `distance_used / distance` of a move; at least 0. A distance below `min_distance_mm`
/// counts as that.
double max_use_by_ball(const MeasuredPoints& measured, const Vector6& move_T,
                       double min_distance_mm) noexcept;
double max_use_by_cylinder(const MeasuredPoints& measured, const Vector6& move_T,
                           double min_distance_mm) noexcept;

/// Returns the sets of vector instructions that this was compiled for, as bits of hwy/targets.h.
std::int64_t near_kernel_targets();

}  // namespace osteomill::barrier_shell
