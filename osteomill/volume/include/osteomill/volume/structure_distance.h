#pragma once

#include <variant>
#include <vector>

#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/nearest_voxels.h"

namespace osteomill {

/// A box along the axes of W.
struct BoxShape {
  Vec3 min_W = Vec3::Zero();
  Vec3 max_W = Vec3::Zero();
};
/// A ball.
struct SphereShape {
  Vec3 center_W = Vec3::Zero();
  double radius_mm = 0;
};
/// A cylinder with flat ends.
struct CylinderShape {
  Vec3 from_W = Vec3::Zero();
  Vec3 to_W = Vec3::UnitZ();
  double radius_mm = 0;
};

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
  /// A shape that has a distance of its own.
  using Solid = std::variant<BoxShape, SphereShape, CylinderShape>;
  static constexpr double kReach_mm = 12;

  explicit StructureDistance(const Solid& solid) : solid_(solid) {}
  /// Takes voxels of a scan. Throws std::invalid_argument if there are none. Long work.
  StructureDistance(const VoxelSet& voxels, const GridGeometry& scan);

  /// Returns the distance of a finite point, mm; 0 inside. Safe in the haptic tick.
  double from(const Vec3& point_W) const noexcept;

 private:
  double from_voxels(const Vec3& point_W) const noexcept;

  // The distance from voxels counts if there are any.
  Solid solid_;
  GridGeometry scan_;
  NearestVoxels nearest_;
};

/// The structures of a bone that no burr may touch, each by its distance.
using NoGoDistances = std::vector<StructureDistance>;

/// Returns the distance of a burr's surface from the nearest structure, mm: negative if the burr reaches into
/// one, not a number if there are none or the burr has no place. Safe in the haptic tick.
double no_go_distance_mm(const NoGoDistances& structures, const Vec3& burr_centre_W,
                         double burr_radius_mm) noexcept;

}  // namespace osteomill
