#include "osteomill/haptics/burr_presses.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

// Distance between sample points on the burr, mm, and their largest number, because every tick samples them.
constexpr double kSampleSpacing_mm = 0.25;
constexpr int kMaxSamples = 256;
// Smallest cosine with the force's direction: at smaller ones the moved ball hardly reaches new space.
constexpr double kMinCosine = 0.25;

}  // namespace

double pressing_reach_mm(const GridGeometry& geometry) {
  constexpr double kMinReach_mm = 0.12;
  return std::max(0.5 * geometry.spacing_mm.maxCoeff(), kMinReach_mm);
}

bool burr_presses(const Volume& volume, double burr_radius_mm, const Vec3& burr_W,
                  const Vec3& force_W_N) noexcept {
  if (!(force_W_N.squaredNorm() > 0)) return false;
  const Vec3 ahead = force_W_N.normalized();
  const Vec3 moved_W = burr_W + pressing_reach_mm(volume.geometry()) * ahead;
  // A sunflower's seeds, from the middle to the rim, each turned on from the last by the golden angle.
  constexpr double kCosine = -0.73736887807831990, kSine = 0.67549029426152364;
  const double cap_mm2 = 2 * std::numbers::pi * (1 - kMinCosine) * burr_radius_mm * burr_radius_mm;
  const int sample_count = static_cast<int>(
      std::clamp(cap_mm2 / (kSampleSpacing_mm * kSampleSpacing_mm), 1.0, static_cast<double>(kMaxSamples)));
  Vec3 turned = ahead.unitOrthogonal();
  for (int n = 0; n < sample_count; ++n) {
    const double cosine = 1 - (1 - kMinCosine) * (n + 0.5) / sample_count;
    const Vec3 direction = cosine * ahead + std::sqrt(1 - cosine * cosine) * turned;
    if (is_bone_at(volume, moved_W + burr_radius_mm * direction)) return true;
    turned = kCosine * turned + kSine * ahead.cross(turned);
  }
  return false;
}

}  // namespace osteomill
