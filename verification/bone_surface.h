#pragma once

#include <vector>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/volume.h"

namespace osteomill::verification {

/// The bone's surface as points, sought independently of every algorithm: where the density between two
/// neighbouring voxels passes the isovalue. The
/// volume outlives it.
class BoneSurface {
 public:
  explicit BoneSurface(const Volume& volume);

  const std::vector<Vec3>& points() const { return points_; }

  /// Returns how deep the deepest point of the surface lies in the tool; negative if none touches it.
  double deepest_mm(const MillingTool& tool, const Pose& X_WT) const;

  /// Returns how deep the deepest point of the tool's centreline lies in bone; 0 if none does.
  double centreline_deep_mm(const MillingTool& tool, const Pose& X_WT) const;

 private:
  // Points that lie in one cube of space.
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
