#pragma once

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// The velocity of a frame: of its origin in mm/s, and its angular velocity in rad/s, both in the outer
/// frame.
struct Twist {
  Vec3 linear_mm_s = Vec3::Zero();
  Vec3 angular_rad_s = Vec3::Zero();
};

}  // namespace osteomill
