#pragma once

#include <algorithm>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// How far off a burr what it presses on may lie: as far as a proxy or a skin keeps it off, and no less than
/// half a voxel, which a coarse scan's surface may be wrong. In mm.
double pressing_reach_mm(const GridGeometry& geometry);

/// Whether bone lies ahead of a burr that presses with this force, no farther off than `pressing_reach_mm`.
/// A wall beside a burr may hold it, but is not what it presses on. Safe in the haptic tick.
bool burr_presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W, const Vec3& force_W_N);

/// A burr may swing on what it presses on: so much of the time for which bone was ahead of it counts as well
/// after the bone has gone, and what could not be spent meanwhile is kept for when it is there again.
inline constexpr double kPressingKept_s = 0.01;

/// `burr_presses` from tick to tick.
class PressingBurr {
 public:
  void reset() { away_s_ = kPressingKept_s; }
  /// Safe in the haptic tick.
  bool presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W, const Vec3& force_W_N,
               double dt_s) {
    const bool ahead = burr_presses(volume, burr_radius_mm, burr_W, force_W_N);
    const bool kept = away_s_ < kPressingKept_s;
    away_s_ = std::clamp(ahead ? away_s_ - dt_s : away_s_ + dt_s, 0.0, kPressingKept_s);
    return ahead || kept;
  }

 private:
  double away_s_ = kPressingKept_s;
};

}  // namespace osteomill
