#include "osteomill/haptics/surface_points/vertex_spring.h"

#include "osteomill/haptics/surface_points/ray_crossing.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {

double interpolated_share(double vertex_density, double free_density, double isovalue) {
  return (vertex_density - isovalue) / (vertex_density - free_density);
}

Vec3 interpolated_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W) {
  const double vertex_density = density_at(volume.grid(), vertex_W);
  if (!(vertex_density > volume.isovalue())) return Vec3::Zero();
  const double free_density = density_at(volume.grid(), free_W);
  return interpolated_share(vertex_density, free_density, volume.isovalue()) * (free_W - vertex_W);
}

Vec3 marched_spring(const Volume& volume, const Vec3& vertex_W, const Vec3& free_W, double known_free_mm) {
  const bool starts_in_bone = known_free_mm <= 0 && density_at(volume.grid(), free_W) > volume.isovalue();
  if (starts_in_bone) return free_W - vertex_W;
  const std::optional<double> share = share_to_bone(volume, free_W, vertex_W, known_free_mm);
  return share ? Vec3((1 - *share) * (free_W - vertex_W)) : Vec3(Vec3::Zero());
}

}  // namespace osteomill::surface_points
