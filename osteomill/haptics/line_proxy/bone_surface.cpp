#include "osteomill/haptics/line_proxy/bone_surface.h"

#include <cmath>
#include <numbers>

namespace osteomill::line_proxy {

std::optional<Vec3> nearest_exit(const Volume& volume, const Vec3& point_W, double reach_mm) {
  if (!is_bone_at(volume, point_W)) return point_W;
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  std::optional<Vec3> exit;
  for (int n = 0; n < 27; ++n) {
    if (n == 13) continue;  // no direction at all
    const Vec3 direction = Vec3(n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1).normalized();
    Vec3 inside = point_W;
    // Each found exit shortens the reach of the rest.
    for (double distance = step_mm; distance <= reach_mm; distance += step_mm) {
      const Vec3 here = point_W + distance * direction;
      if (!is_bone_at(volume, here)) {
        exit = bisect_crossing(volume, here, inside);
        reach_mm = (*exit - point_W).norm();
        break;
      }
      inside = here;
    }
  }
  return exit;
}

std::optional<double> depth_along(const Volume& volume, const Vec3& point_W, const Vec3& out_W,
                                  double reach_mm) {
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  Vec3 inside_W = point_W;
  for (double way_mm = step_mm; way_mm < reach_mm + step_mm; way_mm += step_mm) {
    const Vec3 here_W = point_W + way_mm * out_W;
    if (!is_bone_at(volume, here_W)) return out_W.dot(bisect_crossing(volume, here_W, inside_W) - point_W);
    inside_W = here_W;
  }
  return std::nullopt;
}

std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W, const NormalRule& rule) {
  if (!(rule.spread_voxels > 0.0)) return outward_normal(volume, point_W, rule.kernel);
  const GridGeometry& geometry = volume.geometry();
  const double reach = rule.spread_voxels * std::numbers::inv_sqrt3;
  Vec3 gradient = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 sides(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    // Laid out along the grid's axes, so that a turned scan gives the turned normal.
    const Vec3 aside = geometry.direction * geometry.spacing_mm.cwiseProduct(reach * sides);
    gradient += density_gradient(volume.grid(), point_W + aside, rule.kernel);
  }
  constexpr double kFlatGradient = 1e-9;  // density per mm
  const double steepness = gradient.norm();
  if (!(steepness > kFlatGradient)) return std::nullopt;
  return -gradient / steepness;
}

}  // namespace osteomill::line_proxy
