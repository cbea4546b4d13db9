#pragma once

#include <span>
#include <vector>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Returns the part of `samples`, taken at `rate_hz`, above `cutoff_hz`, without phase shift: a second-order
/// Butterworth high-pass filter run forwards and backwards, with a total attenuation of half the power at the
/// cutoff (0.9 % of the amplitude remains at a quarter of it, 99.8 % at five times). Extends both ends by
/// point reflection. Filters each component separately. Throws std::invalid_argument unless 0 < cutoff_hz <
/// 0.4 rate_hz.
std::vector<Vec3> high_pass(std::span<const Vec3> samples, double rate_hz, double cutoff_hz);

/// Returns the multiple correlation coefficient (0 to 1) of `follower` with `leader`, at five samples from
/// `reach` before to `reach` after the same sample: the root of the fraction of the follower's sum of squares
/// that a linear filter of the leader explains. Both must have zero mean. Uses the samples that are `counted`
/// and have all of these neighbours; NaN if there are fewer than twenty for each fitted coefficient, or if
/// either signal is zero.
double multiple_correlation(std::span<const Vec3> follower, std::span<const Vec3> leader, std::size_t reach,
                            const std::vector<bool>& counted);

}  // namespace osteomill
