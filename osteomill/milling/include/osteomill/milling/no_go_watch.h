#pragma once

#include <memory>
#include <vector>

#include "osteomill/milling/label_tally.h"

namespace osteomill {

/// Detects contact of a burr with no-go structures. Samples points on the burr's surface, one voxel apart
/// (farther apart for large burrs in fine voxels: at most 512 points), so any structure wider than that
/// spacing is found, whether it is bone or not.
class NoGoWatch {
 public:
  /// Generates the sample points; allocates. `labels` may be null; there are then no contacts.
  NoGoWatch(std::shared_ptr<const LabelMap> labels, double burr_radius_mm);

  /// Adds to `tally` every no-go label that the burr touches, with nothing removed. Safe in the haptic tick.
  void tally_contacts(const Vec3& burr_centre_W, LabelTally& tally) const noexcept;

 private:
  std::shared_ptr<const LabelMap> labels_;
  double radius_mm_;
  // Sample points relative to the burr's centre, in W's axes: on the surface, and the centre itself.
  std::vector<Vec3> points_mm_;
};

}  // namespace osteomill
