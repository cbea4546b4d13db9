#pragma once

#include <limits>
#include <vector>

#include "osteomill/exercise/attempt.h"

namespace osteomill {

/// The measured shape of a prepared crown.
struct Crown {
  /// The bone between the surface before and after, along the normal of the surface before.
  std::vector<double> reductions_mm;
  /// The angle of each place of an axial wall with the crown's axis, within 30 degrees: positive for a wall
  /// that leans inward on the way up.
  std::vector<double> wall_angles_deg;
  /// The removed bone of the target that lies below bone which is left; not a number without an axis.
  double undercut_mm3 = std::numeric_limits<double>::quiet_NaN();
};

/// Measures the crown, all over the outer surface of the target; empty if the exercise has no crown's axis.
Crown crown_of(const Attempt& attempt);

}  // namespace osteomill
