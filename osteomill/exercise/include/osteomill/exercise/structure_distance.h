#pragma once

#include "osteomill/exercise/exercise.h"
#include "osteomill/exercise/nearest_voxels.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Returns the distance of a point from a box, mm; 0 inside. Safe in the haptic tick.
double distance_mm(const BoxShape& box, const Vec3& point_W) noexcept;
/// Returns the distance of a point from a sphere, mm; 0 inside. Safe in the haptic tick.
double distance_mm(const SphereShape& sphere, const Vec3& point_W) noexcept;
/// Returns the distance of a point from a cylinder, mm; 0 inside. Safe in the haptic tick.
double distance_mm(const CylinderShape& cylinder, const Vec3& point_W) noexcept;

/// The distance of any point from a structure. A box, sphere or cylinder is measured exactly. A structure of
/// voxels is measured to the cubes of those voxels that are nearest to the eight voxels around the point;
/// farther than `kReach_mm` from the structure's box, the distance may come out up to 1.42 times as long.
class StructureDistance {
 public:
  static constexpr double kReach_mm = 12;

  /// Takes a box, a sphere or a cylinder; other shapes have no distance of their own and throw
  /// std::invalid_argument.
  explicit StructureDistance(const Shape& shape);
  /// Takes voxels of a scan, at least one. Long work.
  StructureDistance(const VoxelSet& voxels, const GridGeometry& scan);

  /// Returns the distance of a finite point, mm; 0 inside. Safe in the haptic tick.
  double from(const Vec3& point_W) const noexcept;

 private:
  double from_voxels(const Vec3& point_W) const noexcept;

  Shape shape_;
  GridGeometry scan_;
  // Empty if the shape is a box, a sphere or a cylinder.
  NearestVoxels nearest_;
};

}  // namespace osteomill
