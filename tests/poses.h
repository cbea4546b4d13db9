#pragma once

#include <algorithm>
#include <cmath>

#include "osteomill/base/pose.h"

namespace osteomill::testing_support {

/// Returns the pose of a tool that descends on top of a ball around the origin of W, mills into it to
/// `depth_mm` and tilts, so that first the burr and then the shaft touches. `progress` runs from 0 to 1.
inline Pose down_and_lean(double ball_radius_mm, double burr_radius_mm, double depth_mm, double progress) {
  const double down = std::min(1.0, 1.5 * progress);
  const double lean = std::max(0.0, progress - 0.6);
  const double height_mm = ball_radius_mm + burr_radius_mm + 0.5 - down * (depth_mm + burr_radius_mm + 0.5);
  return {{0.3 * std::sin(9 * progress), 0, height_mm}, quaternion_from_rotation_vector({0, 2.5 * lean, 0})};
}

}  // namespace osteomill::testing_support
