#include "osteomill/haptics/surface_points/ray_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "osteomill/haptics/surface_points/bone_nearby.h"
#include "osteomill/haptics/surface_points/ray_crossing.h"
#include "osteomill/tool/sample_points.h"
#include "osteomill/volume/sampling.h"

namespace osteomill::surface_points {

namespace {

constexpr double kNoBone = std::numeric_limits<double>::infinity();
// To which a crossing is found.
constexpr double kTolerance_mm = 0.001;
// Contacts of one part this alike are one: 11 degrees apart.
constexpr double kSameNormal = 0.98;
// Rays of the sphere nearer than this are neighbours: its 54 directions lie 21 to 28 degrees apart.
constexpr double kBesideOnSphere_rad = 0.65;
// Where on the shaft's end its rim is looked for, as a share of its radius.
constexpr double kNearRim = 0.85;
// Bone that stands out from a contact's plane by less is the plane's.
constexpr double kOnPlane_mm = 0.01;
// Only bone this near can stop the tool within a stride.
constexpr double kWithinStride_mm = 0.25;

bool is_bone(const Volume& volume, const Vec3& voxel) {
  return density_at_voxel(volume.grid(), voxel) > volume.isovalue();
}

// Where bone is first met along the ray, up to the reach beyond the radius.
double distance_to_bone(const Volume& volume, const VoxelRay& ray, double radius) {
  const double reach = radius + RayContacts::kReach_mm;
  // Near the tool's surface is where bone is met nearly always.
  const double near = std::max(0.0, radius - RayContacts::kReach_mm);
  std::optional<double> met = first_bone(volume, ray, near, reach, kTolerance_mm);
  if (!met && near > 0 && is_bone(volume, ray.origin + near * ray.way))
    met = first_bone(volume, ray, 0, near, kTolerance_mm);
  // No less than is told apart: the nearest direction is sought by inverse distances.
  return met ? std::max(*met, kTolerance_mm) : kNoBone;
}

bool is_min(const RayFan& fan, const RayDistances& distance_mm, std::size_t n) {
  return std::all_of(fan.neighbours[n].begin(), fan.neighbours[n].end(), [&](std::size_t m) {
    return distance_mm[n] < distance_mm[m] || (distance_mm[n] == distance_mm[m] && n < m);
  });
}

std::vector<Vec3> sphere_directions(const MillingTool& tool) {
  std::vector<Vec3> directions;
  // A bump would slip between 24 rays unseen. The mirrored snub cube fills its triangles, the axes fill its
  // squares.
  for (const Vec3& vertex : sphere_vertices(tool)) {
    directions.emplace_back(vertex.normalized());
    directions.emplace_back(-vertex.normalized());
  }
  for (int axis = 0; axis < 3; ++axis) {
    directions.emplace_back(Vec3::Unit(axis));
    directions.emplace_back(-Vec3::Unit(axis));
  }
  return directions;
}

}  // namespace

void RayContacts::prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm) {
  volume_ = &volume;
  tool_ = tool;
  bite_mm_ = bite_mm;
  const GridGeometry& geometry = volume.geometry();
  voxels_per_mm_ = geometry.spacing_mm.cwiseInverse().asDiagonal() * geometry.direction.transpose();
  sphere_ = make_ray_fan(sphere_directions(tool), kBesideOnSphere_rad);
  ring_centres_T_.clear();
  std::vector<Vec3> around;
  for (const ShaftSlice& ring : slice_vertices(tool, rings)) {
    ring_centres_T_.push_back(ring.centre_T);
    if (!around.empty()) continue;
    for (const Vec3& vertex : ring.vertices_T) around.emplace_back((vertex - ring.centre_T).normalized());
  }
  end_points_T_.clear();
  if (!ring_centres_T_.empty()) {
    end_points_T_.emplace_back(0, 0, tool.shaft_length_mm);
    for (const Vec3& direction : around) {
      end_points_T_.emplace_back(end_points_T_.front() + kNearRim * tool.shaft_radius_mm * direction);
    }
  }
  ring_ = make_ray_fan(std::move(around), 2.2 * std::numbers::pi / kSliceVertices);
  seen_mm_.assign(
      sphere_.directions.size() + ring_.directions.size() * ring_centres_T_.size() + end_points_T_.size(),
      kNoBone);
  contacts_.clear();
  // A ray may stand for two: where it goes, and where the surface about it comes nearest.
  contacts_.reserve(2 * (sphere_.directions.size() + ring_.directions.size() * ring_centres_T_.size()) +
                    end_points_T_.size());
}

RayContacts::Rays RayContacts::rays_of(const RayFan& fan, const Pose& X_WT) const {
  Rays rays;
  const Mat3 turn = X_WT.orientation.toRotationMatrix();
  const Mat3 voxels = voxels_per_mm_ * turn;
  for (std::size_t n = 0; n < fan.directions.size(); ++n) {
    rays.directions_W[n] = turn * fan.directions[n];
    rays.ways[n] = voxels * fan.directions[n];
  }
  return rays;
}

// The contact's normal is the tool's own at the place, not the bone's: on an edge of the bone the two differ,
// and only the tool's lets a shaft slide along itself.
void RayContacts::add_contact(const Part& part, const Vec3& centre_W, const Vec3& direction_W,
                              double distance_mm) {
  const RayContact contact{centre_W + part.radius_mm * direction_W, -direction_W,
                           distance_mm - part.radius_mm + part.bite_mm};
  for (std::size_t n = first_of_part_; n < contacts_.size(); ++n) {
    if (contacts_[n].normal_W.dot(contact.normal_W) < kSameNormal) continue;
    if (contact.gap_mm < contacts_[n].gap_mm) contacts_[n] = contact;
    return;
  }
  contacts_.push_back(contact);
}

bool RayContacts::is_explained(const Part& part, const Vec3& direction_W, double distance_mm) const {
  for (std::size_t n = first_of_part_; n < contacts_.size(); ++n) {
    const RayContact& contact = contacts_[n];
    const double plane_mm = contact.gap_mm + part.radius_mm - part.bite_mm;
    if (-distance_mm * direction_W.dot(contact.normal_W) >= plane_mm - kOnPlane_mm) return true;
  }
  return false;
}

// Within the reach of a point of the tool's surface; true where it is not known.
bool RayContacts::bone_near(const Vec3& point_W) const {
  return bone_near_disc(*volume_, point_W, Vec3::Zero(), kReach_mm);
}

// Whether a ray that leaves the tool at `end_W` is followed.
bool RayContacts::is_in_view(std::size_t ray, const Vec3& end_W) const {
  return sees_anew_ ? bone_near(end_W) : seen_mm_[ray] <= view_mm_;
}

void RayContacts::find_at(const Part& part, const Rays& rays, const Vec3& centre_W) {
  const RayFan& fan = *part.fan;
  const std::size_t count = fan.directions.size();
  const Vec3 centre = volume_->geometry().voxel_from_world(centre_W);
  first_of_part_ = contacts_.size();
  RayDistances distance_mm;
  bool any = false;
  for (std::size_t n = 0; n < count; ++n) {
    distance_mm[n] = kNoBone;
    if (is_in_view(part.first_ray + n, centre_W + part.radius_mm * rays.directions_W[n])) {
      distance_mm[n] = distance_to_bone(*volume_, {centre, rays.ways[n]}, part.radius_mm);
      any = any || std::isfinite(distance_mm[n]);
    }
    if (sees_anew_) seen_mm_[part.first_ray + n] = distance_mm[n] - part.radius_mm;
  }
  if (!any) return;
  const auto is_met = [&](std::size_t n) { return std::isfinite(distance_mm[n]); };
  const std::span directions(rays.directions_W.data(), count);
  for (std::size_t n = 0; n < count; ++n) {
    if (!is_met(n) || !is_min(fan, distance_mm, n)) continue;
    const Vec3 nearest = nearest_direction(directions, fan, distance_mm, n, part.axis_W);
    const double there = distance_to_bone(*volume_, {centre, voxels_per_mm_ * nearest}, part.radius_mm);
    const bool nearer = there < distance_mm[n];
    add_contact(part, centre_W, nearer ? nearest : directions[n], nearer ? there : distance_mm[n]);
  }
  for (std::size_t n = 0; n < count; ++n) {
    if (!is_met(n) || distance_mm[n] - part.radius_mm + part.bite_mm > kWithinStride_mm) continue;
    if (is_explained(part, directions[n], distance_mm[n])) continue;
    add_contact(part, centre_W, directions[n], distance_mm[n]);
  }
}

void RayContacts::find_at_end(const Pose& X_WT) {
  const Vec3 axis_W = shaft_direction(X_WT);
  const Vec3 way = voxels_per_mm_ * axis_W;
  const std::size_t first_ray = seen_mm_.size() - end_points_T_.size();
  for (std::size_t n = 0; n < end_points_T_.size(); ++n) {
    const Vec3 end_W = X_WT * end_points_T_[n];
    const VoxelRay ray{volume_->geometry().voxel_from_world(end_W), way};
    std::optional<double> met;
    if (is_in_view(first_ray + n, end_W))
      met = first_bone(*volume_, ray, -kReach_mm, kReach_mm, kTolerance_mm);
    if (met) contacts_.push_back({end_W, -axis_W, *met});
    if (sees_anew_) seen_mm_[first_ray + n] = met.value_or(kNoBone);
  }
}

std::span<const RayContact> RayContacts::find(const Pose& X_WT) {
  sees_anew_ = true;
  std::fill(seen_mm_.begin(), seen_mm_.end(), kNoBone);
  return find_in_view(X_WT);
}

std::span<const RayContact> RayContacts::find_again(const Pose& X_WT, double travel_mm) {
  // Beside a ray bone may be nearer than along it.
  constexpr double kMargin_mm = 0.1;
  sees_anew_ = false;
  view_mm_ = travel_mm + kMargin_mm;
  return find_in_view(X_WT);
}

std::span<const RayContact> RayContacts::find_in_view(const Pose& X_WT) {
  contacts_.clear();
  if (bone_near_disc(*volume_, X_WT.position_mm, Vec3::Zero(), tool_.burr_radius_mm + kReach_mm)) {
    find_at({&sphere_, tool_.burr_radius_mm, bite_mm_, Vec3::Zero(), 0}, rays_of(sphere_, X_WT),
            X_WT.position_mm);
  }
  const Vec3 axis_W = shaft_direction(X_WT);
  Part ring{&ring_, tool_.shaft_radius_mm, 0.0, axis_W, sphere_.directions.size()};
  const Rays rays = rays_of(ring_, X_WT);
  for (const Vec3& centre_T : ring_centres_T_) {
    const Vec3 centre_W = X_WT * centre_T;
    if (bone_near_disc(*volume_, centre_W, axis_W, ring.radius_mm + kReach_mm)) {
      find_at(ring, rays, centre_W);
    }
    ring.first_ray += ring_.directions.size();
  }
  find_at_end(X_WT);
  return contacts_;
}

}  // namespace osteomill::surface_points
