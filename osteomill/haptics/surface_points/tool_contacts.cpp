#include "osteomill/haptics/surface_points/tool_contacts.h"

#include <array>
#include <cmath>
#include <optional>

#include "osteomill/haptics/surface_points/bone_nearby.h"
#include "osteomill/haptics/surface_points/ray_crossing.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/isosurface.h"

namespace osteomill {

namespace {

// A surface that a ray meets at a smaller angle than this (its sine) says little about where the tool
// touches.
constexpr double kGrazing = 0.2;
constexpr int kClosingRays = 2;
// Contacts of one part this alike are one: 11 degrees apart.
constexpr double kSameNormal = 0.98;
// A ray this near to the nearest point (4 degrees) is as good: its error is a quarter of a percent of the
// distance.
constexpr double kCloseEnough = 0.9975;

struct Hit {
  double distance_mm;
  Vec3 normal_W;
};

struct Ray {
  Vec3 direction_W;
  Hit hit;
};

// A way in W in voxels.
Vec3 voxels_along(const GridGeometry& geometry, const Vec3& way_W) {
  return (geometry.direction.transpose() * way_W).cwiseQuotient(geometry.spacing_mm);
}

bool in_bone(const Volume& volume, const Vec3& point_W) {
  return density_at(volume.grid(), point_W) > volume.isovalue();
}

// Where bone is first met from the centre along `direction`, up to the reach beyond the radius.
std::optional<Hit> cast(const Volume& volume, const Vec3& centre, const Vec3& direction, double radius) {
  const double reach = radius + SurfaceContacts::kReach_mm;
  // Near the tool's surface is where bone is met nearly always.
  const double near = std::max(0.0, radius - SurfaceContacts::kReach_mm);
  const bool free_inside = !in_bone(volume, centre + near * direction);
  const Vec3 from = free_inside ? Vec3(centre + near * direction) : centre;
  const Vec3 to = centre + reach * direction;
  const std::optional<double> share = share_to_bone(volume, from, to);
  if (!share) return std::nullopt;
  const Vec3 point = from + *share * (to - from);
  const std::optional<Vec3> normal = outward_normal(volume, point, GradientKernel::smoothed);
  if (!normal || -direction.dot(*normal) < kGrazing) return std::nullopt;
  return Hit{(point - centre).norm(), *normal};
}

// The direction from the centre in which a part (the sphere, or a ring about `axis`) reaches deepest against
// a plane.
std::optional<Vec3> deepest_direction(const Vec3& normal, const Vec3* axis) {
  if (axis == nullptr) return Vec3(-normal);
  const Vec3 across = normal - normal.dot(*axis) * *axis;
  const double length = across.norm();
  if (length < kGrazing) return std::nullopt;
  return Vec3(-across / length);
}

// From a ray that met bone, a few more towards the nearest point of the surface.
Ray close_in(const Volume& volume, const Vec3& centre, Ray ray, double radius, const Vec3* axis) {
  for (int n = 0; n < kClosingRays; ++n) {
    const std::optional<Vec3> deepest = deepest_direction(ray.hit.normal_W, axis);
    if (!deepest) break;
    const double cosine = deepest->dot(ray.direction_W);
    if (cosine > kCloseEnough) return {*deepest, {cosine * ray.hit.distance_mm, ray.hit.normal_W}};
    Vec3 towards = *deepest;
    std::optional<Hit> closer = cast(volume, centre, towards, radius);
    if (!closer || closer->distance_mm > ray.hit.distance_mm) {
      // The plane's nearest point is not there (an edge): half the way may be.
      towards = (ray.direction_W + *deepest).normalized();
      closer = cast(volume, centre, towards, radius);
      if (!closer || closer->distance_mm > ray.hit.distance_mm) break;
    }
    ray = {towards, *closer};
  }
  return ray;
}

}  // namespace

void SurfaceContacts::prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm) {
  volume_ = &volume;
  tool_ = tool;
  bite_mm_ = bite_mm;
  const auto on_sphere = sphere_vertices(tool);
  sphere_T_.assign(on_sphere.begin(), on_sphere.end());
  // A bump would slip between 24 rays unseen. The mirrored snub cube fills its triangles, the axes fill its
  // squares.
  for (const Vec3& vertex : on_sphere) sphere_T_.emplace_back(-vertex);
  for (int axis = 0; axis < 3; ++axis) {
    sphere_T_.emplace_back(tool.burr_radius_mm * Vec3::Unit(axis));
    sphere_T_.emplace_back(-tool.burr_radius_mm * Vec3::Unit(axis));
  }
  ring_centres_T_.clear();
  for (const ShaftSlice& ring : slice_vertices(tool, rings)) {
    ring_centres_T_.push_back(ring.centre_T);
    for (std::size_t n = 0; n < ring_arms_T_.size(); ++n) {
      ring_arms_T_[n] = ring.vertices_T[n] - ring.centre_T;
    }
  }
  contacts_.clear();
  contacts_.reserve(sphere_T_.size() + ring_arms_T_.size() * ring_centres_T_.size());
}

bool SurfaceContacts::is_known(const Vec3& direction_W) const {
  for (std::size_t n = first_of_part_; n < contacts_.size(); ++n) {
    if (-contacts_[n].normal_W.dot(direction_W) > kSameNormal) return true;
  }
  return false;
}

// The contact's normal is the tool's own at the place, not the bone's: on an edge of the bone the two differ,
// and only the tool's lets a shaft slide along itself.
void SurfaceContacts::look_along(const Vec3& centre_W, const Vec3& direction_W, double radius_mm,
                                 double bite_mm, const Vec3* axis_W) {
  const std::optional<Hit> hit = cast(*volume_, centre_W, direction_W, radius_mm);
  if (!hit) return;
  const std::optional<Vec3> deepest = deepest_direction(hit->normal_W, axis_W);
  if (deepest && is_known(*deepest)) return;
  const Ray ray = close_in(*volume_, centre_W, {direction_W, *hit}, radius_mm, axis_W);
  const ToolContact contact{centre_W + radius_mm * ray.direction_W, -ray.direction_W,
                            ray.hit.distance_mm - radius_mm + bite_mm};
  for (std::size_t n = first_of_part_; n < contacts_.size(); ++n) {
    if (contacts_[n].normal_W.dot(contact.normal_W) < kSameNormal) continue;
    if (contact.gap_mm < contacts_[n].gap_mm) contacts_[n] = contact;
    return;
  }
  contacts_.push_back(contact);
}

void SurfaceContacts::find_at_sphere(const Pose& X_WT) {
  const double radius = tool_.burr_radius_mm;
  first_of_part_ = contacts_.size();
  if (!bone_near_disc(*volume_, X_WT.position_mm, Vec3::Zero(), radius + kReach_mm)) return;
  for (const Vec3& vertex_T : sphere_T_) {
    const Vec3 direction = X_WT.orientation * vertex_T / radius;
    if (!in_bone(*volume_, X_WT.position_mm + (radius + kReach_mm) * direction)) continue;
    look_along(X_WT.position_mm, direction, radius, bite_mm_, nullptr);
  }
}

void SurfaceContacts::find_at_rings(const Pose& X_WT) {
  const double radius = tool_.shaft_radius_mm;
  const Vec3 axis = shaft_direction(X_WT);
  std::array<Vec3, kSliceVertices> direction;
  std::array<Vec3, kSliceVertices> feeler_voxels;
  for (std::size_t n = 0; n < direction.size(); ++n) {
    direction[n] = X_WT.orientation * ring_arms_T_[n] / radius;
    feeler_voxels[n] = voxels_along(volume_->geometry(), (radius + kReach_mm) * direction[n]);
  }
  for (const Vec3& centre_T : ring_centres_T_) {
    const Vec3 centre = X_WT * centre_T;
    if (!bone_near_disc(*volume_, centre, axis, radius + kReach_mm)) continue;
    const Vec3 centre_voxel = volume_->geometry().voxel_from_world(centre);
    first_of_part_ = contacts_.size();
    for (std::size_t n = 0; n < direction.size(); ++n) {
      if (!(density_at_voxel(volume_->grid(), centre_voxel + feeler_voxels[n]) > volume_->isovalue())) {
        continue;
      }
      look_along(centre, direction[n], radius, 0.0, &axis);
    }
  }
}

std::span<const ToolContact> SurfaceContacts::find(const Pose& X_WT) {
  contacts_.clear();
  find_at_sphere(X_WT);
  find_at_rings(X_WT);
  return contacts_;
}

}  // namespace osteomill
