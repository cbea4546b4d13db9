#pragma once

#include <memory>
#include <vector>

#include "osteomill/milling/label_tally.h"

namespace osteomill {

/// Watches whether a burr touches a structure that no burr may touch. It looks at points on the burr's
/// surface, a voxel apart (on large burrs in fine voxels further, 512 points at the most): any structure as
/// wide as that is found when the burr reaches it, bone or not.
class NoGoWatch {
 public:
  /// Places the points on the burr. Allocates. `labels` may be null: then nothing is found.
  NoGoWatch(std::shared_ptr<const LabelMap> labels, double burr_radius_mm);

  /// Adds to `tally` every no-go label that the burr touches, with nothing removed. Safe in the haptic tick.
  void tally_contacts(const Vec3& burr_centre_W, LabelTally& tally) const noexcept;

 private:
  std::shared_ptr<const LabelMap> labels_;
  double radius_mm_;
  // The points on the burr's surface, and its centre, as seen from that centre in W's axes.
  std::vector<Vec3> points_mm_;
};

}  // namespace osteomill
