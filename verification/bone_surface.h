#pragma once

#include <vector>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill::verification {

/// Samples the bone's surface independently of every algorithm: a point on each grid edge on which the
/// density crosses the isovalue. The volume must outlive it.
class BoneSurface {
 public:
  explicit BoneSurface(const Volume& volume);

  const std::vector<Vec3>& points() const { return points_; }

  /// Returns the depth of the surface's deepest point in the tool, mm; negative if none touches it.
  double deepest_mm(const MillingTool& tool, const Pose& X_WT) const;

  /// Returns the depth in bone of the centreline's deepest point, mm; 0 if none is in bone.
  double centreline_depth_mm(const MillingTool& tool, const Pose& X_WT) const;

 private:
  // Points in one cube of space.
  struct Bin {
    Vec3 centre_W;
    std::size_t first;
    std::size_t last;
  };
  double distance_mm(const Vec3& point_W) const;

  const Volume& volume_;
  std::vector<Vec3> points_;
  std::vector<Bin> bins_;
};

}  // namespace osteomill::verification
