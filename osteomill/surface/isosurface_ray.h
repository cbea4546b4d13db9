#pragma once

#include <optional>

#include "osteomill/volume/volume.h"

namespace osteomill {

/// Where a ray meets the bone.
struct RayHit {
  Vec3 point_W;
  /// Out of the bone, a unit vector: against the gradient smoothed over a voxel to all sides, or out of the
  /// grid where the ray met the bone in the grid's border.
  Vec3 normal_W;
};

/// Follows straight lines to the bone. Keeps a reference to the volume, and where its bone lay when made.
class BoneRays {
 public:
  explicit BoneRays(const Volume& volume);

  /// The first point of the isosurface on the endless line through `origin_W` along the unit vector
  /// `direction_W`, coming from its far beginning. Bricks without bone are passed over.
  std::optional<RayHit> first_on_line(const Vec3& origin_W, const Vec3& direction_W) const;

 private:
  RayHit hit_between(const Vec3& outside_W, const Vec3& inside_W, const Vec3& direction_W) const;

  const Volume& volume_;
  /// Voxel coordinates between which all cells lie that may hold bone; empty where first > last.
  Vec3 first_voxel_;
  Vec3 last_voxel_;
};

}  // namespace osteomill
