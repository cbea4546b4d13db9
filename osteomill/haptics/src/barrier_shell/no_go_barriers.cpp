#include "barrier_shell/no_go_barriers.h"

#include <algorithm>

#include "barrier_shell/certificate.h"

namespace osteomill::barrier_shell {

namespace {

// Range of the guard's barrier beyond the minimum distance, mm: from kYield_mm inside guard_mm to kYield_mm
// outside.
constexpr double kNoGoBarrierWidth_mm = 2 * NoGoBarriers::kYield_mm;
// p0 is the skin's times the default burr's cross-section, so a burr is held as by a hole of its own shape.
constexpr Barrier kNoGoBarrier{kNoGoBarrierWidth_mm, 21};
// Closer than this share of the width at the start, the guard would push with more than any device's force.
constexpr double kHeldGapShare = 0.2;
// Upper bound on the slope of an interpolated distance, which is at most sqrt(3).
constexpr double kMaxDistanceSlope = 2;

}  // namespace

NoGoBarriers::NoGoBarriers(const NoGoDistances* structures, const MillingTool& tool) {
  if (structures == nullptr) return;
  for (const WatchedStructure& one : *structures) {
    if (!one.guard_mm) continue;
    const double off_mm = std::max(0.0, tool.burr_radius_mm + *one.guard_mm - kYield_mm);
    const double least_mm = off_mm + one.distance.max_excess_mm(off_mm);
    no_go_barriers_.push_back({&one.distance, least_mm, least_mm});
  }
}

void NoGoBarriers::begin_at(const Vec3& burr_W) noexcept {
  for (NoGoBarrier& guard : no_go_barriers_) {
    const double distance_mm = guard.structure->distance_and_gradient_from(burr_W).distance_mm;
    const bool is_outside = distance_mm > guard.full_offset_mm + kHeldGapShare * kNoGoBarrierWidth_mm;
    guard.least_mm = is_outside ? guard.full_offset_mm : distance_mm - kNoGoBarrierWidth_mm;
  }
}

void NoGoBarriers::follow(const Vec3& burr_W) noexcept {
  for (NoGoBarrier& guard : no_go_barriers_) {
    if (guard.least_mm == guard.full_offset_mm) continue;
    const double grown_mm =
        guard.structure->distance_and_gradient_from(burr_W).distance_mm - kNoGoBarrierWidth_mm;
    guard.least_mm = std::clamp(grown_mm, guard.least_mm, guard.full_offset_mm);
  }
}

bool NoGoBarriers::is_clear(const Vec3& burr_W, double move_mm) const noexcept {
  return std::ranges::all_of(no_go_barriers_, [&](const NoGoBarrier& guard) {
    return guard.gap_mm(burr_W) - kMaxDistanceSlope * move_mm >= kNoGoBarrierWidth_mm;
  });
}

// Moves are too short to pass through a guard from outside to outside. Checks the distance at the move's end,
// because it is not smooth everywhere.
double NoGoBarriers::safe_step_fraction(const Vec3& burr_W, const Vec3& move_W_mm) const noexcept {
  constexpr int kTries = 8;
  constexpr double kShorter = 0.5;
  double share = 1;
  for (const NoGoBarrier& guard : no_go_barriers_) {
    const DistanceAndGradient slope = guard.structure->distance_and_gradient_from(burr_W);
    const double gap_mm = slope.distance_mm - guard.least_mm;
    if (gap_mm - kMaxDistanceSlope * move_W_mm.norm() >= kNoGoBarrierWidth_mm) continue;
    share = std::min(share, certified_fraction(-slope.gradient_W.dot(move_W_mm) / gap_mm));
    for (int n = 0; guard.gap_mm(burr_W + share * move_W_mm) < kMinDistanceShare * gap_mm; ++n) {
      if (n == kTries) return 0;
      share *= kShorter;
    }
  }
  return share;
}

// Omits the distance's own second derivative, which would let the tool slide slightly faster around a
// structure.
double NoGoBarriers::add_to(EnergySum& sum, const Pose& X_WT) const noexcept {
  double energy_Nmm = 0;
  for (const NoGoBarrier& guard : no_go_barriers_) {
    const DistanceAndGradient slope = guard.structure->distance_and_gradient_from(X_WT.position_mm);
    const double gap_mm = slope.distance_mm - guard.least_mm;
    if (gap_mm >= kNoGoBarrierWidth_mm) continue;
    const Barrier::Value push = kNoGoBarrier.at(gap_mm);
    const Vec3 outward_T = X_WT.orientation.conjugate() * slope.gradient_W;
    energy_Nmm += push.energy;
    sum.gradient.head<3>() -= push.pressure * outward_T;
    sum.convex.topLeftCorner<3, 3>() += push.stiffness * outward_T * outward_T.transpose();
    ++sum.touching;
  }
  sum.energy_Nmm += energy_Nmm;
  return energy_Nmm;
}

}  // namespace osteomill::barrier_shell
