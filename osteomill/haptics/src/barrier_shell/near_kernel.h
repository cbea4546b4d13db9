#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>

#include "barrier_shell/near_points.h"
#include "bone_points/brick_points.h"

namespace osteomill::barrier_shell {

/// Region in which points are gathered: for the ball within `near_mm` of it; for the cylinder within
/// `near_mm` plus `per_lever` times the point's distance from the burr's centre.
struct GatherRegion {
  Cores cores;
  double near_mm = 0;
  double per_lever = 0;
};

/// Appends the points of a brick that lie in the part's region; `frame` maps the brick's frame to T. The
/// first call selects the widest SIMD target of the processor; all targets give the same bits. That applies
/// to all functions below too. Safe in the haptic tick.
void gather_near_ball(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                      const GatherRegion& region, NearPoints& near) noexcept;
void gather_near_cylinder(const BrickPoints& points, std::uint32_t first_chunk, const Frame& frame,
                          const GatherRegion& region, NearPoints& near) noexcept;

/// Sums over points on the ball. With n the outward direction, p the push, q = p / r and m = psi'' + q:
/// energy, q, p n and m n n^T.
enum class BallSum { energy, q, px, py, pz, mxx, mxy, mxz, myy, myz, mzz, count };
/// Sums over points on the cylinder's side. With n = (u, v, 0), p the push, q = p / rho and m = psi'' + q:
/// energy, and q, p n, m n n^T and p rho n n^T, times powers of z as named.
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

/// Sums over points in `NearPoints::kLanes` lanes each, indexed by BallSum or SideSum.
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

/// Sum over points and measure each, for measure_ball and measure_cylinder. Points at the cylinder's ends are
/// listed in `measured.at_end` and excluded from the sums.
void sum_ball(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              Lanes<BallSum>& lanes, MeasuredPoints& measured) noexcept;
void sum_side(const NearPoints& near, const Frame& moved, const Cores& cores, const Barrier& barrier,
              Lanes<SideSum>& lanes, MeasuredPoints& measured) noexcept;

/// Return the largest `distance_used / distance` of a move; at least 0. Distances are clamped to at least
/// `min_distance_mm`.
double max_use_by_ball(const MeasuredPoints& measured, const Vector6& move_T,
                       double min_distance_mm) noexcept;
double max_use_by_cylinder(const MeasuredPoints& measured, const Vector6& move_T,
                           double min_distance_mm) noexcept;

/// Returns the SIMD targets for which this was compiled, as bits of hwy/targets.h.
std::int64_t near_kernel_targets();

}  // namespace osteomill::barrier_shell
