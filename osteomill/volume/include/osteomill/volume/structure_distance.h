#pragma once

#include <optional>
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

/// A distance, and the direction in which it grows times how much it grows along that.
struct DistanceSlope {
  double distance_mm = 0;
  Vec3 gradient_W = Vec3::Zero();
};

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
  /// Returns the distance without steps and its gradient; both 0 inside. A solid's are exact. Between voxels'
  /// centres the distance is interpolated: if the true one is d, it is at most `max_excess_mm(d)` more.
  /// Farther than `kReach_mm` from the structure's box it is that of the nearest point within that reach.
  /// Safe in the haptic tick.
  DistanceSlope slope_from(const Vec3& point_W) const noexcept;
  /// Returns by how much `slope_from` may exceed a true distance. Safe in the haptic tick.
  double max_excess_mm(double distance_mm) const noexcept;

 private:
  double from_voxels(const Vec3& point_W) const noexcept;
  double voxel_distance2_mm2(const Vec3& point, const VoxelIndex& near) const noexcept;
  VoxelIndex cell_corner(const Vec3& point) const noexcept;
  DistanceSlope slope_from_voxels(const Vec3& point_W) const noexcept;

  // The distance from voxels counts if there are any.
  Solid solid_;
  GridGeometry scan_;
  NearestVoxels nearest_;
};

/// A structure that no burr may touch.
struct WatchedStructure {
  StructureDistance distance;
  /// The distance at which an algorithm that guards structures holds the burr's surface off it; nothing if it
  /// does not.
  std::optional<double> guard_mm = {};
};

/// The structures of a bone that no burr may touch.
using NoGoDistances = std::vector<WatchedStructure>;

/// Returns how many of the structures have a guard.
int guard_count(const NoGoDistances& structures);

/// Returns the distance of a burr's surface from the nearest structure, mm: negative if the burr reaches into
/// one, not a number if there are none or the burr has no place. Safe in the haptic tick.
double no_go_distance_mm(const NoGoDistances& structures, const Vec3& burr_centre_W,
                         double burr_radius_mm) noexcept;

}  // namespace osteomill
