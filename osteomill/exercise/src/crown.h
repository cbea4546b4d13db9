#pragma once

#include <limits>
#include <vector>

#include "osteomill/exercise/attempt.h"

namespace osteomill {

/// Measured shape of a prepared crown.
struct Crown {
  /// Thickness between the surface before and after, along the normal of the surface before.
  std::vector<double> reductions_mm;
  /// Angles between points of the axial walls and the crown's axis, within 30 degrees; positive for a wall
  /// that leans inward towards the top.
  std::vector<double> wall_angles_deg;
  /// Volume of removed target bone below remaining bone; NaN without an axis.
  double undercut_mm3 = std::numeric_limits<double>::quiet_NaN();
};

/// Measures the crown over the target's outer surface; empty if the exercise has no crown axis.
Crown crown_of(const Attempt& attempt);

}  // namespace osteomill
