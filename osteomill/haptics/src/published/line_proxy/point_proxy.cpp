#include "published/line_proxy/point_proxy.h"

#include <algorithm>
#include <numbers>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

constexpr int kSlides = 8;
// Points on the isosurface are accurate to the tolerance of bisect_crossing (1e-6 mm).
constexpr double kTouching_mm = 4e-6;
constexpr double kAtRest_mm = 1e-5;
// Distance from a point to the eight gradient samples of its normal.
constexpr double kSpread_voxels = 1.25;

double voxel_mm(const Volume& volume) {
  return volume.geometry().spacing_mm.minCoeff();
}

// Returns the point at which a ray from a point in bone along a unit vector leaves the bone, sampled every
// `step_mm` up to `reach_mm`.
std::optional<Vec3> exit_along(const Volume& volume, const Vec3& point_W, const Vec3& out_W, double step_mm,
                               double reach_mm) {
  Vec3 inside_W = point_W;
  for (int n = 1; n * step_mm <= reach_mm; ++n) {
    const Vec3 here_W = point_W + n * step_mm * out_W;
    if (!is_bone_at(volume, here_W)) return bisect_crossing(volume, here_W, inside_W);
    inside_W = here_W;
  }
  return std::nullopt;
}

// Moves a point in bone out along the surface normal, at most two voxels.
std::optional<Vec3> exit_along_normal(const Volume& volume, const Vec3& point_W) {
  const auto normal = surface_normal(volume, point_W);
  if (!normal) return std::nullopt;
  return exit_along(volume, point_W, *normal, 0.25 * voxel_mm(volume), 2 * voxel_mm(volume));
}

// Slides along the tangent and back to the isosurface. If the surface falls away by more than 45 degrees,
// leaves the point in free space for the next march; if it rises by more than that, stops at the wall.
Vec3 slide_along_surface(const Volume& volume, const Vec3& proxy_W, const Vec3& tangent, const Vec3& normal) {
  const Vec3 aside = proxy_W + tangent;
  const double reach_mm = tangent.norm() + kTouching_mm;
  if (!is_bone_at(volume, aside)) {
    const Vec3 below = aside - reach_mm * normal;
    return is_bone_at(volume, below) ? bisect_crossing(volume, aside, below) : aside;
  }
  const Vec3 above = aside + reach_mm * normal;
  return bisect_crossing(volume, is_bone_at(volume, above) ? proxy_W : above, aside);
}

// Moves straight toward the probe until bone blocks the way.
Vec3 march_to_probe(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W) {
  const Vec3 path = probe_W - proxy_W;
  const double distance = path.norm();
  if (distance == 0.0) return probe_W;
  if (distance > kTouching_mm && is_bone_at(volume, proxy_W + (kTouching_mm / distance) * path))
    return proxy_W;
  return first_crossing(volume, proxy_W, probe_W).value_or(probe_W);
}

}  // namespace

std::optional<Vec3> nearest_exit(const Volume& volume, const Vec3& point_W, double reach_mm) {
  if (!is_bone_at(volume, point_W)) return point_W;
  std::optional<Vec3> exit;
  for (int n = 0; n < 27; ++n) {
    if (n == 13) continue;  // the zero vector
    const Vec3 direction = Vec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1).normalized();
    const auto found = exit_along(volume, point_W, direction, 0.5 * voxel_mm(volume), reach_mm);
    if (!found) continue;
    exit = found;
    // Each exit found shortens the reach of the remaining directions.
    reach_mm = (*exit - point_W).norm();
  }
  return exit;
}

std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W) {
  const GridGeometry& geometry = volume.geometry();
  const double reach = kSpread_voxels * std::numbers::inv_sqrt3;
  Vec3 gradient = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sides(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    // Offset along the grid's axes, so that the normal rotates with the scan.
    const Vec3 aside = geometry.direction * geometry.spacing_mm.cwiseProduct(reach * sides);
    gradient += density_gradient(volume.grid(), point_W + aside);
  }
  constexpr double kFlatGradient = 1e-9;  // density per mm
  const double steepness = gradient.norm();
  if (!(steepness > kFlatGradient)) return std::nullopt;
  return -gradient / steepness;
}

Vec3 move_point_proxy(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W) {
  Vec3 proxy = proxy_W;
  if (is_bone_at(volume, proxy)) {
    const auto out = exit_along_normal(volume, proxy);
    if (!out) return proxy_W;
    proxy = *out;
  }
  for (int n = 0; n < kSlides; ++n) {
    proxy = march_to_probe(volume, proxy, probe_W);
    if (proxy == probe_W) return proxy;
    const auto normal = surface_normal(volume, proxy);
    if (!normal) return proxy;
    const Vec3 to_probe = probe_W - proxy;
    const Vec3 aside = to_probe - to_probe.dot(*normal) * *normal;
    const double aside_mm = aside.norm();
    if (aside_mm < kAtRest_mm) return proxy;
    // A slide of more than a voxel could step over a wall or a crack.
    proxy =
        slide_along_surface(volume, proxy, std::min(aside_mm, voxel_mm(volume)) / aside_mm * aside, *normal);
  }
  return proxy;
}

}  // namespace osteomill::line_proxy
