#pragma once

#include "osteomill/volume/volume.h"

namespace osteomill {

/// How far off a burr what it presses on may lie: a voxel, since the voxels of a dense bone lie up to that
/// behind its surface, and no less than what a proxy or a skin keeps it off. In mm.
double pressing_reach_mm(const GridGeometry& geometry);

/// Whether bone lies ahead of a burr that presses with this force, no farther off than `pressing_reach_mm`.
/// A wall beside a burr may hold it, but is not what it presses on. Safe in the haptic tick.
bool burr_presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W, const Vec3& force_W_N);

/// For so long after bone was last ahead of it a burr counts as pressing, and what it could not spend
/// meanwhile is kept for when bone is there again: it may swing on what it presses on.
inline constexpr double kPressingKept_s = 0.01;

/// The same from tick to tick.
class PressingBurr {
 public:
  void reset() { away_s_ = kPressingKept_s; }
  /// Safe in the haptic tick.
  bool presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W, const Vec3& force_W_N,
               double dt_s) {
    away_s_ = burr_presses(volume, burr_radius_mm, burr_W, force_W_N) ? 0 : away_s_ + dt_s;
    return away_s_ < kPressingKept_s;
  }

 private:
  double away_s_ = kPressingKept_s;
};

}  // namespace osteomill
