#pragma once

#include <array>
#include <span>
#include <vector>

#include "osteomill/haptics/surface_points/ray_fan.h"
#include "osteomill/tool/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill::surface_points {

/// A place where a tool touches bone, or would within a short way: the tool's point there, the bone's outward
/// unit normal, and the way left between the two along it (negative where they overlap). In W.
struct RayContact {
  Vec3 point_W;
  Vec3 normal_W;
  double gap_mm = 0;
};

/// Finds where the burr's sphere and the free shaft are near bone, from outside it. Rays go out from the
/// burr's centre, and from the middle of each ring of the shaft through the ring's vertices. A ray that meets
/// bone sooner than those beside it stands for a contact: together they say where the surface, taken to be
/// flat there, comes nearest, and one more ray looks there. Other rays count where their bone stands out from
/// all planes so found. Rays along the shaft find what its end meets. A ray that starts in bone finds
/// nothing.
class RayContacts {
 public:
  /// `rings` circles along the free shaft. The burr may stand `bite_mm` deep in bone before a contact counts
  /// as overlap. Allocates.
  void prepare(const Volume& volume, const MillingTool& tool, int rings, double bite_mm);
  /// The most contacts that `find` can give. Safe in the haptic tick.
  std::size_t capacity() const { return contacts_.capacity(); }
  /// The contacts within `kReach_mm` of the tool at `X_WT`, until the next call. Safe in the haptic tick.
  std::span<const RayContact> find(const Pose& X_WT);
  /// The same where no point of the tool is farther than `travel_mm` from where it was when `find` looked
  /// last: only those rays are followed again along which bone was near enough then. Safe in the haptic tick.
  std::span<const RayContact> find_again(const Pose& X_WT, double travel_mm);

  /// How far from the tool's surface bone is noticed.
  static constexpr double kReach_mm = 0.3;

 private:
  // The sphere, or a ring about `axis_W`.
  struct Part {
    const RayFan* fan;
    double radius_mm;
    double bite_mm;
    Vec3 axis_W;
    // The place of its first ray in `seen_mm_`.
    std::size_t first_ray;
  };
  // A fan's directions as the tool stands, and as ways through the grid (voxels a mm).
  struct Rays {
    std::array<Vec3, RayFan::kMaxRays> directions_W;
    std::array<Vec3, RayFan::kMaxRays> ways;
  };
  Rays rays_of(const RayFan& fan, const Pose& X_WT) const;
  void find_at(const Part& part, const Rays& rays, const Vec3& centre_W);
  void find_at_end(const Pose& X_WT);
  bool bone_near(const Vec3& point_W) const;
  std::span<const RayContact> find_in_view(const Pose& X_WT);
  bool is_in_view(std::size_t ray, const Vec3& end_W) const;
  void add_contact(const Part& part, const Vec3& centre_W, const Vec3& direction_W, double distance_mm);
  bool is_explained(const Part& part, const Vec3& direction_W, double distance_mm) const;

  const Volume* volume_ = nullptr;
  MillingTool tool_;
  Mat3 voxels_per_mm_ = Mat3::Identity();
  double bite_mm_ = 0;
  RayFan sphere_;
  RayFan ring_;
  std::vector<Vec3> ring_centres_T_;
  // On the shaft's end: its middle and near its rim.
  std::vector<Vec3> end_points_T_;
  std::vector<RayContact> contacts_;
  // How far beyond the tool's surface each ray met bone when all were followed last, and up to where that
  // counts now.
  std::vector<double> seen_mm_;
  double view_mm_ = 0;
  bool sees_anew_ = true;
  // Of the part looked at.
  std::size_t first_of_part_ = 0;
};

}  // namespace osteomill::surface_points
