#include "osteomill/haptics/line_proxy/bone_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "osteomill/volume/sampling.h"

namespace osteomill::line_proxy {

namespace {

struct Span {
  double first = 0.0;
  double last = 1.0;
};

// The part of the segment, as fractions of it, in the grid and the one voxel around it where densities still
// fall.
std::optional<Span> span_in_grid(const GridGeometry& geometry, const Vec3& from_W, const Vec3& to_W) {
  const Vec3 from = geometry.voxel_from_world(from_W);
  const Vec3 way = geometry.voxel_from_world(to_W) - from;
  Span span;
  for (int axis = 0; axis < 3; ++axis) {
    const double min = -1.0;
    const double max = geometry.dims[static_cast<std::size_t>(axis)];
    if (way[axis] == 0.0) {
      if (from[axis] < min || from[axis] > max) return std::nullopt;
      continue;
    }
    const double a = (min - from[axis]) / way[axis];
    const double b = (max - from[axis]) / way[axis];
    span.first = std::max(span.first, std::min(a, b));
    span.last = std::min(span.last, std::max(a, b));
  }
  if (!(span.first <= span.last)) return std::nullopt;
  return span;
}

}  // namespace

std::optional<Vec3> crossing_in_grid(const Volume& volume, const Vec3& from_W, const Vec3& to_W) {
  const auto span = span_in_grid(volume.geometry(), from_W, to_W);
  if (!span) return std::nullopt;
  const Vec3 way = to_W - from_W;
  // Unclipped ends are passed on as they are: a start on the surface must not move by a rounding error.
  const Vec3 first = span->first > 0.0 ? Vec3(from_W + span->first * way) : from_W;
  const Vec3 last = span->last < 1.0 ? Vec3(from_W + span->last * way) : to_W;
  return first_crossing(volume, first, last);
}

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
