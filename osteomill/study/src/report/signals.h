#pragma once

#include <span>
#include <vector>

#include "osteomill/base/pose.h"

namespace osteomill {

/// Returns the part of `samples`, taken `rate_hz` times a second, that lies above `cutoff_hz`, without
/// shifting it in time: a second-order Butterworth high pass run forwards and then backwards, so placed that
/// both together let half the power through at the cutoff (0.9 % of the amplitude at a quarter of it, 99.8 %
/// at five times). The ends are continued by their point reflection. Components are filtered each by itself.
/// Throws std::invalid_argument unless 0 < cutoff_hz < 0.4 rate_hz.
std::vector<Vec3> high_pass(std::span<const Vec3> samples, double rate_hz, double cutoff_hz);

/// Returns how much of a vector signal follows another: the multiple correlation coefficient (0 for nothing,
/// 1 for all) of `follower` with `leader` at the same sample and up to `reach` samples before and after it,
/// that is the root of the share of the follower's squares that a linear filter of the leader explains. Both
/// have a mean of zero. It is taken over the samples that are `counted` and have all of their neighbours; not
/// a number if those are fewer than twenty for each coefficient that is fitted, or if either is zero.
double multiple_correlation(std::span<const Vec3> follower, std::span<const Vec3> leader, std::size_t reach,
                            const std::vector<bool>& counted);

}  // namespace osteomill
