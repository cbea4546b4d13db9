#pragma once

#include <span>
#include <vector>

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// What of `samples`, taken `rate_hz` times a second, lies above `cutoff_hz`, without shifting it in time: a
/// second-order Butterworth high pass run forwards and then backwards, so placed that both together let half
/// the power through at the cutoff (0.9 % of the amplitude at a quarter of it, 99.8 % at five times). The
/// ends are continued by their point reflection. Components are filtered each by itself. Throws
/// std::invalid_argument unless 0 < cutoff_hz < 0.4 rate_hz.
std::vector<Vec3> high_pass(std::span<const Vec3> samples, double rate_hz, double cutoff_hz);

}  // namespace osteomill
