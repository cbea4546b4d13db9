#include "barrier_shell/guards.h"

#include <algorithm>

#include "barrier_shell/certificate.h"

namespace osteomill::barrier_shell {

namespace {

// Range of the guard's barrier beyond the minimum distance, mm: from kYield_mm inside guard_mm to kYield_mm
// outside.
constexpr double kGuardWidth_mm = 2 * Guards::kYield_mm;
// p0 is the skin's times the default burr's cross-section, so a burr is held as by a hole of its own shape.
constexpr Barrier kGuardBarrier{kGuardWidth_mm, 21};
// Closer than this share of the width at the start, the guard would push with more than any device's force.
constexpr double kHeldGapShare = 0.2;
// Upper bound on the slope of an interpolated distance, which is at most sqrt(3).
constexpr double kSteepest = 2;

}  // namespace

Guards::Guards(const NoGoDistances* structures, const MillingTool& tool) {
  if (structures == nullptr) return;
  for (const WatchedStructure& one : *structures) {
    if (!one.guard_mm) continue;
    const double off_mm = std::max(0.0, tool.burr_radius_mm + *one.guard_mm - kYield_mm);
    const double least_mm = off_mm + one.distance.max_excess_mm(off_mm);
    guards_.push_back({&one.distance, least_mm, least_mm});
  }
}

void Guards::begin_at(const Vec3& burr_W) noexcept {
  for (Guard& guard : guards_) {
    const double distance_mm = guard.structure->slope_from(burr_W).distance_mm;
    const bool is_outside = distance_mm > guard.whole_mm + kHeldGapShare * kGuardWidth_mm;
    guard.least_mm = is_outside ? guard.whole_mm : distance_mm - kGuardWidth_mm;
  }
}

void Guards::follow(const Vec3& burr_W) noexcept {
  for (Guard& guard : guards_) {
    if (guard.least_mm == guard.whole_mm) continue;
    const double grown_mm = guard.structure->slope_from(burr_W).distance_mm - kGuardWidth_mm;
    guard.least_mm = std::clamp(grown_mm, guard.least_mm, guard.whole_mm);
  }
}

bool Guards::are_clear(const Vec3& burr_W, double move_mm) const noexcept {
  return std::ranges::all_of(guards_, [&](const Guard& guard) {
    return guard.gap_mm(burr_W) - kSteepest * move_mm >= kGuardWidth_mm;
  });
}

// Moves are too short to pass through a guard from outside to outside. Checks the distance at the move's end,
// because it is not smooth everywhere.
double Guards::share_kept(const Vec3& burr_W, const Vec3& move_W_mm) const noexcept {
  constexpr int kTries = 8;
  constexpr double kShorter = 0.5;
  double share = 1;
  for (const Guard& guard : guards_) {
    const DistanceSlope slope = guard.structure->slope_from(burr_W);
    const double gap_mm = slope.distance_mm - guard.least_mm;
    if (gap_mm - kSteepest * move_W_mm.norm() >= kGuardWidth_mm) continue;
    share = std::min(share, certified_share(-slope.gradient_W.dot(move_W_mm) / gap_mm));
    for (int n = 0; guard.gap_mm(burr_W + share * move_W_mm) < kDistanceKept * gap_mm; ++n) {
      if (n == kTries) return 0;
      share *= kShorter;
    }
  }
  return share;
}

// Omits the distance's own second derivative, which would let the tool slide slightly faster around a
// structure.
double Guards::add_to(EnergySum& sum, const Pose& X_WT) const noexcept {
  double energy_Nmm = 0;
  for (const Guard& guard : guards_) {
    const DistanceSlope slope = guard.structure->slope_from(X_WT.position_mm);
    const double gap_mm = slope.distance_mm - guard.least_mm;
    if (gap_mm >= kGuardWidth_mm) continue;
    const Barrier::Value push = kGuardBarrier.at(gap_mm);
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
