#pragma once

#include <memory>
#include <vector>

#include "osteomill/milling/label_tally.h"

namespace osteomill {

/// Whether a burr touches a structure that no burr may touch. Looked for at points on the burr's surface, a
/// voxel apart (on large burrs in fine voxels further, 512 points at the most): whatever is as wide as that
/// is found when the burr reaches it, bone or not.
class NoGoWatch {
 public:
  /// Allocates. Null for no labels.
  NoGoWatch(std::shared_ptr<const LabelMap> labels, double burr_radius_mm);

  /// Adds to `tally` every no-go label that the burr touches, with nothing removed. Safe in the haptic tick.
  void look(const Vec3& burr_centre_W, LabelTally& tally) const noexcept;

 private:
  std::shared_ptr<const LabelMap> labels_;
  double radius_mm_;
  // From the burr's centre, in W: on its surface, and that centre.
  std::vector<Vec3> points_mm_;
};

}  // namespace osteomill
