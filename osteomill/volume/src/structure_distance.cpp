#include "osteomill/volume/structure_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace osteomill {

namespace {

VoxelBox grown_by_reach(const VoxelBox& box, const Vec3& spacing_mm) {
  const auto voxels = [&](Eigen::Index axis) {
    return static_cast<int>(std::ceil(StructureDistance::kReach_mm / spacing_mm[axis]));
  };
  return {{box.first.i - voxels(0), box.first.j - voxels(1), box.first.k - voxels(2)},
          {box.last.i + voxels(0), box.last.j + voxels(1), box.last.k + voxels(2)}};
}

Vec3 nearest_point_W(const BoxShape& box, const Vec3& point_W) {
  return point_W.cwiseMax(box.min_W).cwiseMin(box.max_W);
}

Vec3 nearest_point_W(const SphereShape& sphere, const Vec3& point_W) {
  const Vec3 out = point_W - sphere.center_W;
  return sphere.center_W + std::min(1.0, sphere.radius_mm / out.norm()) * out;
}

Vec3 nearest_point_W(const CylinderShape& cylinder, const Vec3& point_W) {
  const Vec3 axis = cylinder.to_W - cylinder.from_W;
  const double along = (point_W - cylinder.from_W).dot(axis) / axis.squaredNorm();
  const Vec3 out = point_W - cylinder.from_W - along * axis;
  return cylinder.from_W + std::clamp(along, 0.0, 1.0) * axis +
         std::min(1.0, cylinder.radius_mm / out.norm()) * out;
}

}  // namespace

double distance_mm(const BoxShape& box, const Vec3& point_W) noexcept {
  return (box.min_W - point_W).cwiseMax(point_W - box.max_W).cwiseMax(0).norm();
}

double distance_mm(const SphereShape& sphere, const Vec3& point_W) noexcept {
  return std::max(0.0, (point_W - sphere.center_W).norm() - sphere.radius_mm);
}

double distance_mm(const CylinderShape& cylinder, const Vec3& point_W) noexcept {
  const Vec3 axis = cylinder.to_W - cylinder.from_W;
  const double length_mm = axis.norm();
  const Vec3 from_start = point_W - cylinder.from_W;
  const double along_mm = from_start.dot(axis) / length_mm;
  const double aside_mm = (from_start - along_mm / length_mm * axis).norm();
  return std::hypot(std::max(0.0, aside_mm - cylinder.radius_mm),
                    std::max({0.0, -along_mm, along_mm - length_mm}));
}

StructureDistance::StructureDistance(const VoxelSet& voxels, const GridGeometry& scan)
    : scan_(scan),
      nearest_(voxels, grown_by_reach(voxels.box(), scan.spacing_mm), scan.spacing_mm,
               NearestVoxels::To::faces) {
  if (!nearest_.found()) throw std::invalid_argument("StructureDistance: the structure has no voxels");
}

double StructureDistance::from(const Vec3& point_W) const noexcept {
  if (nearest_.found()) return from_voxels(point_W);
  return std::visit([&](const auto& solid) { return distance_mm(solid, point_W); }, solid_);
}

DistanceAndGradient StructureDistance::distance_and_gradient_from(const Vec3& point_W) const noexcept {
  if (nearest_.found()) return slope_from_voxels(point_W);
  return std::visit(
      [&](const auto& solid) -> DistanceAndGradient {
        const double distance = distance_mm(solid, point_W);
        if (!(distance > 0)) return {};
        return {distance, (point_W - nearest_point_W(solid, point_W)).normalized()};
      },
      solid_);
}

// Let d be the distance, n the direction to the nearest point and a the offset to a corner. Then |d n + a| <=
// d + n a + a^2 / 2 d. Summed with the interpolation weights, the second term vanishes and the third is at
// most the result. The excess also never exceeds the mean of |a|, which is at most half a voxel's diagonal.
double StructureDistance::max_excess_mm(double distance_mm) const noexcept {
  if (!nearest_.found()) return 0;
  const double half_mm = 0.5 * scan_.spacing_mm.norm();
  return 2 * distance_mm > half_mm ? half_mm * half_mm / (2 * distance_mm) : half_mm;
}

double StructureDistance::voxel_distance2_mm2(const Vec3& point, const VoxelIndex& near) const noexcept {
  const Vec3 outside = ((point - Vec3(near.i, near.j, near.k)).cwiseAbs().array() - 0.5).cwiseMax(0);
  return outside.cwiseProduct(scan_.spacing_mm).squaredNorm();
}

// Returns the lowest of the eight voxels around a point, clamped to the box of `nearest_`.
VoxelIndex StructureDistance::cell_corner(const Vec3& point) const noexcept {
  const VoxelBox& box = nearest_.box();
  const Vec3 first(box.first.i, box.first.j, box.first.k), last(box.last.i, box.last.j, box.last.k);
  const Vec3 low = point.cwiseMax(first).cwiseMin(last - Vec3::Ones()).array().floor();
  return {static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z())};
}

double StructureDistance::from_voxels(const Vec3& point_W) const noexcept {
  const Vec3 point = scan_.voxel_from_world(point_W);
  const VoxelIndex corner = cell_corner(point);
  double least2_mm2 = std::numeric_limits<double>::infinity();
  for_each(VoxelBox{corner, {corner.i + 1, corner.j + 1, corner.k + 1}}, [&](const VoxelIndex& v) {
    least2_mm2 = std::min(least2_mm2, voxel_distance2_mm2(point, nearest_.nearest_to(v)));
  });
  return std::sqrt(least2_mm2);
}

DistanceAndGradient StructureDistance::slope_from_voxels(const Vec3& point_W) const noexcept {
  const Vec3 point = scan_.voxel_from_world(point_W);
  const VoxelIndex corner = cell_corner(point);
  const Vec3 share = (point - Vec3(corner.i, corner.j, corner.k)).cwiseMax(0).cwiseMin(1);
  double distance_mm = 0;
  Vec3 rise = Vec3::Zero();
  for_each(VoxelBox{corner, {corner.i + 1, corner.j + 1, corner.k + 1}}, [&](const VoxelIndex& v) {
    const Vec3 upper(v.i - corner.i, v.j - corner.j, v.k - corner.k);
    const Vec3 weight = upper.cwiseProduct(share) + (Vec3::Ones() - upper).cwiseProduct(Vec3::Ones() - share);
    const double here_mm = std::sqrt(voxel_distance2_mm2(Vec3(v.i, v.j, v.k), nearest_.nearest_to(v)));
    distance_mm += weight.prod() * here_mm;
    const Vec3 across(weight.y() * weight.z(), weight.x() * weight.z(), weight.x() * weight.y());
    rise += here_mm * (2 * upper - Vec3::Ones()).cwiseProduct(across);
  });
  return {distance_mm, scan_.direction * rise.cwiseQuotient(scan_.spacing_mm)};
}

int count_guards(const NoGoDistances& structures) {
  return static_cast<int>(
      std::ranges::count_if(structures, [](const auto& one) { return one.guard_mm.has_value(); }));
}

double no_go_distance_mm(const NoGoDistances& structures, const Vec3& burr_centre_W,
                         double burr_radius_mm) noexcept {
  double least_mm = std::numeric_limits<double>::quiet_NaN();
  if (!burr_centre_W.allFinite()) return least_mm;
  for (const WatchedStructure& structure : structures)
    least_mm = std::fmin(least_mm, structure.distance.from(burr_centre_W) - burr_radius_mm);
  return least_mm;
}

}  // namespace osteomill
