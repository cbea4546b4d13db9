#include "osteomill/haptics/line_proxy/surface_normal.h"

#include <numbers>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

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
