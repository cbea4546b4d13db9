#include "osteomill/haptics/line_proxy/point_proxy.h"

#include <algorithm>
#include <optional>

#include "osteomill/haptics/line_proxy/bone_surface.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

constexpr int kSlides = 8;
// Points on the isosurface are known to within the tolerance of bisect_crossing (1e-6 mm).
constexpr double kTouching_mm = 4e-6;
constexpr double kAtRest_mm = 1e-5;

double voxel_mm(const Volume& volume) {
  return volume.geometry().spacing_mm.minCoeff();
}

// A point that is in bone moved out along the surface's normal, two voxels at most.
std::optional<Vec3> raised_out(const Volume& volume, const Vec3& point_W, const NormalRule& rule) {
  const auto normal = surface_normal(volume, point_W, rule);
  if (!normal) return std::nullopt;
  Vec3 inside = point_W;
  for (int n = 1; n <= 8; ++n) {
    const Vec3 here = point_W + 0.25 * n * voxel_mm(volume) * *normal;
    if (!is_bone_at(volume, here)) return bisect_crossing(volume, here, inside);
    inside = here;
  }
  return std::nullopt;
}

// Along the tangent and back to the isosurface. Where the surface falls away by more than 45 degrees the
// point is left in the air, for the next march; where it rises by more than that the slide ends at the wall.
Vec3 slid(const Volume& volume, const Vec3& proxy_W, const Vec3& tangent, const Vec3& normal) {
  const Vec3 aside = proxy_W + tangent;
  const double reach_mm = tangent.norm() + kTouching_mm;
  if (!is_bone_at(volume, aside)) {
    const Vec3 below = aside - reach_mm * normal;
    return is_bone_at(volume, below) ? bisect_crossing(volume, aside, below) : aside;
  }
  const Vec3 above = aside + reach_mm * normal;
  return bisect_crossing(volume, is_bone_at(volume, above) ? proxy_W : above, aside);
}

// Straight toward the probe until bone is in the way.
Vec3 marched(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W) {
  const Vec3 way = probe_W - proxy_W;
  const double distance = way.norm();
  if (distance == 0.0) return probe_W;
  if (distance > kTouching_mm && is_bone_at(volume, proxy_W + (kTouching_mm / distance) * way))
    return proxy_W;
  return first_crossing(volume, proxy_W, probe_W).value_or(probe_W);
}

}  // namespace

Vec3 move_point_proxy(const Volume& volume, const Vec3& proxy_W, const Vec3& probe_W, const NormalRule& rule,
                      double friction) {
  Vec3 proxy = proxy_W;
  if (is_bone_at(volume, proxy)) {
    const auto out = raised_out(volume, proxy, rule);
    if (!out) return proxy_W;
    proxy = *out;
  }
  for (int n = 0; n < kSlides; ++n) {
    proxy = marched(volume, proxy, probe_W);
    if (proxy == probe_W) return proxy;
    const auto normal = surface_normal(volume, proxy, rule);
    if (!normal) return proxy;
    const Vec3 to_probe = probe_W - proxy;
    const Vec3 aside = to_probe - to_probe.dot(*normal) * *normal;
    // On the cone of friction: its edge is left behind, its inside holds.
    const double slip_mm = aside.norm() - friction * std::max(0.0, -to_probe.dot(*normal));
    if (slip_mm < kAtRest_mm) return proxy;
    // A slide of more than a voxel could step over a wall or a crack.
    proxy = slid(volume, proxy, std::min(slip_mm, voxel_mm(volume)) / aside.norm() * aside, *normal);
  }
  return proxy;
}

}  // namespace osteomill::line_proxy
