#include "osteomill/tool/burr_presses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "osteomill/volume/isosurface.h"

namespace osteomill {

namespace {

// How far apart the burr is looked at, and how often at most; it is asked in every tick.
constexpr double kApart_mm = 0.15;
constexpr int kMaxLooks = 512;
// The cosine with the force's direction beyond which the ball, moved on, hardly goes where it was not.
constexpr double kRim = 0.25;

}  // namespace

double pressing_reach_mm(const GridGeometry& geometry) {
  constexpr double kKeptOff_mm = 0.12;
  return std::max(geometry.spacing_mm.maxCoeff(), kKeptOff_mm);
}

bool burr_presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W, const Vec3& force_W_N) {
  if (!(force_W_N.squaredNorm() > 0)) return false;
  const Vec3 ahead = force_W_N.normalized();
  const Vec3 moved_W = burr_W + pressing_reach_mm(volume.geometry()) * ahead;
  const Vec3 aside = ahead.unitOrthogonal();
  const Vec3 across = ahead.cross(aside);
  // A sunflower's seeds, from the middle to the rim.
  constexpr double kGoldenAngle = std::numbers::pi * (3 - 2.2360679774997896964);
  const double cap_mm2 = 2 * std::numbers::pi * (1 - kRim) * burr_radius_mm * burr_radius_mm;
  const int looks =
      static_cast<int>(std::clamp(cap_mm2 / (kApart_mm * kApart_mm), 1.0, static_cast<double>(kMaxLooks)));
  for (int n = 0; n < looks; ++n) {
    const double cosine = 1 - (1 - kRim) * (n + 0.5) / looks;
    const double sine = std::sqrt(1 - cosine * cosine);
    const double angle = kGoldenAngle * n;
    const Vec3 direction = cosine * ahead + sine * (std::cos(angle) * aside + std::sin(angle) * across);
    if (is_bone_at(volume, moved_W + burr_radius_mm * direction)) return true;
  }
  return false;
}

}  // namespace osteomill
