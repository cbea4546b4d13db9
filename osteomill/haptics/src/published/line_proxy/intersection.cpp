#include "published/line_proxy/intersection.h"

#include <cmath>
#include <limits>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

std::optional<WalkHit> most_active_vertex(const Volume& volume, std::span<const Vec3> vertices_T,
                                          const Pose& before, const Pose& at) {
  std::optional<WalkHit> most_active;
  for (const Vec3& vertex_T : vertices_T) {
    const Vec3 at_W = at * vertex_T;
    const double density = density_at(volume.grid(), at_W);
    if (!(density > volume.isovalue())) continue;
    const Vec3 before_W = before * vertex_T;
    const double density_before = density_at(volume.grid(), before_W);
    const double fraction = (volume.isovalue() - density_before) / (density - density_before);  // eq. 1
    if (!most_active || fraction < most_active->fraction) most_active = WalkHit{before_W, at_W, fraction};
  }
  return most_active;
}

constexpr int kSubsteps = 4;

// Returns a quarter of the vertex spacing along b; zero if b has no direction.
Vec3 substep_along(const Vec3& b, std::span<const Vec3> vertices_T) {
  const double length = b.norm();
  if (vertices_T.size() < 2 || !(length > 0.0) || !std::isfinite(length)) return Vec3::Zero();
  return (vertices_T[1] - vertices_T[0]).norm() / kSubsteps / length * b;
}

}  // namespace

std::optional<WalkHit> walk_to_collision(const Volume& volume, std::span<const Vec3> vertices_T,
                                         const Pose& X_WT_before, const Pose& X_WT, const WalkSteps& steps) {
  const Vec3 step_d = (X_WT.position_mm - X_WT_before.position_mm) / steps.translation;  // eq. 3
  const Quat turn = X_WT.orientation * X_WT_before.orientation.conjugate();
  const Vec3 step_alpha = rotation_vector(turn) / steps.rotation;  // eq. 4
  Pose before = X_WT_before;
  for (int n = 1; n <= steps.translation + steps.rotation; ++n) {
    Pose at = X_WT;  // the last step of each part ends exactly there
    if (n < steps.translation) at.position_mm = X_WT_before.position_mm + n * step_d;
    if (n <= steps.translation) {
      at.orientation = X_WT_before.orientation;
    } else if (n < steps.translation + steps.rotation) {
      at.orientation =
          quaternion_from_rotation_vector((n - steps.translation) * step_alpha) * X_WT_before.orientation;
    }
    if (const auto hit = most_active_vertex(volume, vertices_T, before, at)) return hit;
    before = at;
  }
  return std::nullopt;
}

ShaftProbe densest_point(const Volume& volume, std::span<const Vec3> vertices_T, const Pose& X_WT,
                         const Vec3& intersection_before_W) {
  const Vec3 substep = substep_along(X_WT.position_mm - intersection_before_W, vertices_T);
  double densest = -std::numeric_limits<double>::infinity();
  Vec3 first = X_WT * vertices_T.front();
  Vec3 last = first;
  bool in_run = false;
  for (const Vec3& vertex_T : vertices_T) {
    const Vec3 vertex_W = X_WT * vertex_T;
    // b points down the shaft, so on the way up the farthest sub-step comes first.
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

}  // namespace osteomill::line_proxy
