#pragma once

#include <algorithm>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// Returns how far from the burr's surface the bone that it presses on may lie, in mm: as far as a proxy or a
/// skin keeps the burr away, and at least half a voxel, by which the surface of a coarse scan may be wrong.
double pressing_reach_mm(const GridGeometry& geometry);

/// Returns whether bone lies ahead of a burr that presses with this force, no farther off than
/// `pressing_reach_mm`. A wall beside the burr may hold it, but the burr does not press on it. Safe in the
/// haptic tick.
bool burr_presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W,
                  const Vec3& force_W_N) noexcept;

/// A burr may swing on the bone that it presses on and lose it for some ticks. It still counts as pressing
/// for as long as bone was ahead of it before, and at most for this time. Milling keeps an unspent budget for
/// the same time.
inline constexpr double kPressingKept_s = 0.01;

/// Follows `burr_presses` from tick to tick, and keeps it true for kPressingKept_s.
class PressingBurr {
 public:
  /// Safe in the haptic tick.
  bool presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W, const Vec3& force_W_N,
               double dt_s) noexcept {
    const bool ahead = burr_presses(volume, burr_radius_mm, burr_W, force_W_N);
    const bool pressed_recently = away_s_ < kPressingKept_s;
    away_s_ = std::clamp(ahead ? away_s_ - dt_s : away_s_ + dt_s, 0.0, kPressingKept_s);
    return ahead || pressed_recently;
  }

 private:
  double away_s_ = kPressingKept_s;
};

}  // namespace osteomill
