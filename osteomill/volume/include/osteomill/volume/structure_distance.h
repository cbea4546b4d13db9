#pragma once

#include <optional>
#include <variant>
#include <vector>

#include "osteomill/volume/grid_geometry.h"
#include "osteomill/volume/nearest_voxels.h"

namespace osteomill {

/// Box aligned with the axes of W.
struct BoxShape {
  Vec3 min_W = Vec3::Zero();
  Vec3 max_W = Vec3::Zero();
};
/// Sphere.
struct SphereShape {
  Vec3 center_W = Vec3::Zero();
  double radius_mm = 0;
};
/// Cylinder with flat ends.
struct CylinderShape {
  Vec3 from_W = Vec3::Zero();
  Vec3 to_W = Vec3::UnitZ();
  double radius_mm = 0;
};

/// Returns the distance from a point to a box, mm; 0 inside. Safe in the haptic tick.
double distance_mm(const BoxShape& box, const Vec3& point_W) noexcept;
/// Returns the distance from a point to a sphere, mm; 0 inside. Safe in the haptic tick.
double distance_mm(const SphereShape& sphere, const Vec3& point_W) noexcept;
/// Returns the distance from a point to a cylinder, mm; 0 inside. Safe in the haptic tick.
double distance_mm(const CylinderShape& cylinder, const Vec3& point_W) noexcept;

/// Distance and its gradient.
struct DistanceAndGradient {
  double distance_mm = 0;
  Vec3 gradient_W = Vec3::Zero();
};

/// Distance from any point to a structure; exact for a box, sphere or cylinder. For a structure of voxels it
/// is the distance to the cubes of the voxels nearest to the eight voxels around the point; farther than
/// `kReach_mm` from the structure's bounding box it may be up to 1.42 times too long.
class StructureDistance {
 public:
  /// Shape with an analytic distance.
  using Solid = std::variant<BoxShape, SphereShape, CylinderShape>;
  static constexpr double kReach_mm = 12;

  explicit StructureDistance(const Solid& solid) : solid_(solid) {}
  /// Measures to a set of voxels of a scan. Throws std::invalid_argument if the set is empty. Long work.
  StructureDistance(const VoxelSet& voxels, const GridGeometry& scan);

  /// Returns the distance to a finite point, mm; 0 inside. Safe in the haptic tick.
  double from(const Vec3& point_W) const noexcept;
  /// Returns a continuous distance and its gradient; both 0 inside. Exact for a solid. For voxels it is
  /// interpolated between their centres and exceeds the true distance d by at most `max_excess_mm(d)`.
  /// Farther than `kReach_mm` from the structure's bounding box it is the distance of the nearest point
  /// within that reach. Safe in the haptic tick.
  DistanceAndGradient distance_and_gradient_from(const Vec3& point_W) const noexcept;
  /// Returns the most by which `distance_and_gradient_from` may exceed the true distance `distance_mm`, mm.
  /// Safe in the haptic tick.
  double max_excess_mm(double distance_mm) const noexcept;

 private:
  double from_voxels(const Vec3& point_W) const noexcept;
  double voxel_distance2_mm2(const Vec3& point, const VoxelIndex& near) const noexcept;
  VoxelIndex cell_corner(const Vec3& point) const noexcept;
  DistanceAndGradient slope_from_voxels(const Vec3& point_W) const noexcept;

  // Used only if `nearest_` holds no voxels.
  Solid solid_;
  GridGeometry scan_;
  NearestVoxels nearest_;
};

/// A structure that no burr may touch.
struct WatchedStructure {
  StructureDistance distance;
  /// Clearance that a guarding algorithm keeps between the burr's surface and the structure; nullopt if not
  /// guarded.
  std::optional<double> guard_mm = {};
};

/// The structures of a bone that no burr may touch.
using NoGoDistances = std::vector<WatchedStructure>;

/// Returns the number of structures with a guard.
int count_guards(const NoGoDistances& structures);

/// Returns the distance from a burr's surface to the nearest structure, mm: negative if the burr penetrates
/// one, NaN if there are none or the burr's position is not finite. Safe in the haptic tick.
double no_go_distance_mm(const NoGoDistances& structures, const Vec3& burr_centre_W,
                         double burr_radius_mm) noexcept;

}  // namespace osteomill
