#include "osteomill/haptics/surface_points/ray_crossing.h"

#include <algorithm>
#include <cmath>

#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {

namespace {

struct Sample {
  double at;
  double above;  // density above the isovalue
};

double above_isovalue(const Volume& volume, const VoxelRay& ray, double at) {
  return density_at_voxel(volume.grid(), ray.origin + at * ray.way) - volume.isovalue();
}

// Regula falsi with the Illinois halving, which keeps one end from standing still.
double close_in(const Volume& volume, const VoxelRay& ray, Sample outside, Sample inside, double tolerance) {
  for (int n = 0; n < 8 && inside.at - outside.at > tolerance; ++n) {
    const double fraction = outside.above / (outside.above - inside.above);
    const double at = outside.at + fraction * (inside.at - outside.at);
    const double above = above_isovalue(volume, ray, at);
    if (std::abs(at - inside.at) < tolerance || std::abs(at - outside.at) < tolerance) return at;
    if (above > 0) {
      inside = {at, above};
      outside.above *= 0.5;
    } else {
      outside = {at, above};
      inside.above *= 0.5;
    }
  }
  return outside.at;
}

}  // namespace

std::optional<double> first_bone(const Volume& volume, const VoxelRay& ray, double from, double to,
                                 double tolerance) {
  Sample before{from, above_isovalue(volume, ray, from)};
  if (before.above > 0) return std::nullopt;
  const double voxels = (to - from) * ray.way.norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * std::min(voxels, 1e4))));
  const double step = (to - from) / steps;
  for (int n = 1; n <= steps; ++n) {
    const double at = from + n * step;
    const Sample here{at, above_isovalue(volume, ray, at)};
    if (here.above > 0) return close_in(volume, ray, before, here, tolerance * step);
    before = here;
  }
  return std::nullopt;
}

std::optional<double> share_to_bone(const Volume& volume, const Vec3& from_W, const Vec3& to_W,
                                    double known_free_mm) {
  constexpr double kTolerance = 1e-3;
  const Vec3 from = volume.geometry().voxel_from_world(from_W);
  const VoxelRay ray{from, volume.geometry().voxel_from_world(to_W) - from};
  if (!(known_free_mm > 0)) return first_bone(volume, ray, 0, 1, kTolerance);
  const double free = std::min(1.0, known_free_mm / (to_W - from_W).norm());
  if (above_isovalue(volume, ray, free) > 0) return first_bone(volume, ray, 0, free, kTolerance);
  return free < 1 ? first_bone(volume, ray, free, 1, kTolerance) : std::nullopt;
}

}  // namespace osteomill::surface_points
