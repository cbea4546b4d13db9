#include "osteomill/haptics/line_proxy/shaft_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

constexpr int kSubsteps = 4;

// A quarter of the vertices' spacing along b; nothing where b has no direction.
Vec3 substep_along(const Vec3& b, std::span<const Vec3> vertices_T) {
  const double length = b.norm();
  if (vertices_T.size() < 2 || !(length > 0.0) || !std::isfinite(length)) return Vec3::Zero();
  return (vertices_T[1] - vertices_T[0]).norm() / kSubsteps / length * b;
}

}  // namespace

ShaftProbe densest_point(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                         const Vec3& intersection_before_W) {
  const Vec3 substep = substep_along(X_WT.position_mm - intersection_before_W, vertices_T);
  double densest = -std::numeric_limits<double>::infinity();
  Vec3 first = X_WT * vertices_T.front();
  Vec3 last = first;
  bool in_run = false;
  for (const Vec3& vertex_T : vertices_T) {
    const Vec3 vertex_W = X_WT * vertex_T;
    // b points down the shaft, so that the farthest sub-step comes first on the way up.
    for (int n = kSubsteps - 1; n >= 0; --n) {
      const Vec3 point_W = vertex_W + n * substep;
      const double density = density_at(volume.grid(), point_W);
      if (density > densest) {
        densest = density;
        first = last = point_W;
        in_run = true;
      } else if (density == densest && in_run) {
        last = point_W;
      } else {
        in_run = false;
      }
    }
  }
  return {0.5 * (first + last), densest};
}

int vertices_in_bone(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT) {
  int count = 0;
  for (const Vec3& vertex_T : vertices_T) {
    if (density_at(volume.grid(), X_WT * vertex_T) > volume.isovalue()) ++count;
  }
  return count;
}

}  // namespace osteomill::line_proxy
