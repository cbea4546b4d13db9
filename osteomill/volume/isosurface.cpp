#include "osteomill/volume/isosurface.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

constexpr double kFlatGradient = 1e-9;  // density per mm

}  // namespace

std::optional<Vec3> outward_normal(const Volume& volume, const Vec3& point_W, GradientKernel kernel) {
  const Vec3 gradient = density_gradient(volume.grid(), point_W, kernel);
  const double steepness = gradient.norm();
  if (!(steepness > kFlatGradient)) return std::nullopt;
  return -gradient / steepness;
}

Vec3 bisect_crossing(const Volume& volume, Vec3 outside_W, Vec3 inside_W, double tolerance_mm) {
  for (int n = 0; n < 60 && (inside_W - outside_W).norm() > tolerance_mm; ++n) {
    const Vec3 middle = 0.5 * (outside_W + inside_W);
    (is_bone_at(volume, middle) ? inside_W : outside_W) = middle;
  }
  return outside_W;
}

std::optional<Vec3> first_crossing(const Volume& volume, const Vec3& from_W, const Vec3& to_W) {
  if (is_bone_at(volume, from_W)) return from_W;
  const double step_mm = 0.5 * volume.geometry().spacing_mm.minCoeff();
  const int steps = std::max(1, static_cast<int>(std::ceil((to_W - from_W).norm() / step_mm)));
  Vec3 before = from_W;
  for (int n = 1; n <= steps; ++n) {
    const Vec3 here = from_W + (static_cast<double>(n) / steps) * (to_W - from_W);
    if (is_bone_at(volume, here)) return bisect_crossing(volume, before, here);
    before = here;
  }
  return std::nullopt;
}

}  // namespace osteomill
