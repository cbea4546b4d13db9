#include "osteomill/haptics/surface_points/ray_crossing.h"

#include <algorithm>
#include <cmath>

#include "osteomill/volume/sampling.h"

namespace osteomill {

namespace {

struct Sample {
  double share;
  double above;  // density above the isovalue
};

// Regula falsi with the Illinois halving, which keeps one end from standing still.
double close_in(const Volume& volume, const Vec3& from, const Vec3& way, Sample outside, Sample inside,
                double tolerance) {
  for (int n = 0; n < 8 && inside.share - outside.share > tolerance; ++n) {
    const double fraction = outside.above / (outside.above - inside.above);
    const double share = outside.share + fraction * (inside.share - outside.share);
    const double above = density_at_voxel(volume.grid(), from + share * way) - volume.isovalue();
    if (std::abs(share - inside.share) < tolerance || std::abs(share - outside.share) < tolerance) {
      return share;
    }
    if (above > 0) {
      inside = {share, above};
      outside.above *= 0.5;
    } else {
      outside = {share, above};
      inside.above *= 0.5;
    }
  }
  return outside.share;
}

}  // namespace

std::optional<double> share_to_bone(const Volume& volume, const Vec3& from_W, const Vec3& to_W) {
  const Vec3 from = volume.geometry().voxel_from_world(from_W);
  const Vec3 way = volume.geometry().voxel_from_world(to_W) - from;
  const auto above = [&](double share) {
    return density_at_voxel(volume.grid(), from + share * way) - volume.isovalue();
  };
  Sample before{0, above(0)};
  if (before.above > 0) return std::nullopt;
  const double voxels = way.norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * std::min(voxels, 1e4))));
  for (int n = 1; n <= steps; ++n) {
    const double share = static_cast<double>(n) / steps;
    const Sample here{share, above(share)};
    if (here.above > 0) return close_in(volume, from, way, before, here, 1e-3 / steps);
    before = here;
  }
  return std::nullopt;
}

}  // namespace osteomill
