#pragma once

#include "osteomill/volume/volume.h"

namespace osteomill::surface_points {

/// False only where no point of the disc (its axis a unit vector in W; zero makes it a ball) is in bone; by
/// brick, so it errs by up to a brick. Costs less than two density samples. Safe in the haptic tick.
bool bone_near_disc(const Volume& volume, const Vec3& centre_W, const Vec3& axis_W, double radius_mm);

}  // namespace osteomill::surface_points
