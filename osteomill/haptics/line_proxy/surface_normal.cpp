#include "osteomill/haptics/line_proxy/surface_normal.h"

#include <array>
#include <numbers>

#include "osteomill/volume/isosurface.h"

namespace osteomill::line_proxy {

std::optional<Vec3> surface_normal(const Volume& volume, const Vec3& point_W, const NormalRule& rule) {
  if (!(rule.spread_voxels > 0.0)) return outward_normal(volume, point_W, rule.kernel);
  static constexpr std::array<std::array<double, 3>, 4> kTetrahedron{
      {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};
  const GridGeometry& geometry = volume.geometry();
  const double reach = rule.spread_voxels * std::numbers::inv_sqrt3;
  Vec3 gradient = Vec3::Zero();
  for (const auto& corner : kTetrahedron) {
    // Laid out along the grid's axes, so that a turned scan gives the turned normal.
    const Vec3 aside = geometry.direction * geometry.spacing_mm.cwiseProduct(reach * Vec3(corner.data()));
    gradient += density_gradient(volume.grid(), point_W + aside, rule.kernel);
  }
  constexpr double kFlatGradient = 1e-9;  // density per mm
  const double steepness = gradient.norm();
  if (!(steepness > kFlatGradient)) return std::nullopt;
  return -gradient / steepness;
}

}  // namespace osteomill::line_proxy
