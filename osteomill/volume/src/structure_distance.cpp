#include "osteomill/volume/structure_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace osteomill {

namespace {

VoxelBox reached_from(const VoxelBox& box, const Vec3& spacing_mm) {
  const auto voxels = [&](Eigen::Index axis) {
    return static_cast<int>(std::ceil(StructureDistance::kReach_mm / spacing_mm[axis]));
  };
  return {{box.first.i - voxels(0), box.first.j - voxels(1), box.first.k - voxels(2)},
          {box.last.i + voxels(0), box.last.j + voxels(1), box.last.k + voxels(2)}};
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
    : scan_(scan), nearest_(voxels, reached_from(voxels.box(), scan.spacing_mm), scan.spacing_mm) {
  if (!nearest_.found()) throw std::invalid_argument("StructureDistance: the structure has no voxels");
}

double StructureDistance::from(const Vec3& point_W) const noexcept {
  if (nearest_.found()) return from_voxels(point_W);
  return std::visit([&](const auto& solid) { return distance_mm(solid, point_W); }, solid_);
}

double StructureDistance::from_voxels(const Vec3& point_W) const noexcept {
  const Vec3 point = scan_.voxel_from_world(point_W);
  const VoxelBox& box = nearest_.box();
  const Vec3 first(box.first.i, box.first.j, box.first.k), last(box.last.i, box.last.j, box.last.k);
  const Vec3 low = point.cwiseMax(first).cwiseMin(last - Vec3::Ones()).array().floor();
  const VoxelIndex corner{static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z())};
  double least2_mm2 = std::numeric_limits<double>::infinity();
  for_each(VoxelBox{corner, {corner.i + 1, corner.j + 1, corner.k + 1}}, [&](const VoxelIndex& v) {
    const VoxelIndex near = nearest_.nearest_to(v);
    const Vec3 outside = ((point - Vec3(near.i, near.j, near.k)).cwiseAbs().array() - 0.5).cwiseMax(0);
    least2_mm2 = std::min(least2_mm2, outside.cwiseProduct(scan_.spacing_mm).squaredNorm());
  });
  return std::sqrt(least2_mm2);
}

double no_go_distance_mm(const NoGoDistances& structures, const Vec3& burr_centre_W,
                         double burr_radius_mm) noexcept {
  double least_mm = std::numeric_limits<double>::quiet_NaN();
  if (!burr_centre_W.allFinite()) return least_mm;
  for (const StructureDistance& structure : structures)
    least_mm = std::fmin(least_mm, structure.from(burr_centre_W) - burr_radius_mm);
  return least_mm;
}

}  // namespace osteomill
