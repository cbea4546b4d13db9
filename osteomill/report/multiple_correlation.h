#pragma once

#include <span>
#include <vector>

#include "osteomill/geometry/pose.h"

namespace osteomill {

/// How much of a vector signal follows another: the multiple correlation coefficient (0 for nothing, 1 for
/// all) of `follower` with `leader` at the same sample and up to `reach` samples before and after it, that
/// is the root of the share of the follower's squares that a linear filter of the leader explains. Both have
/// a mean of zero (high_pass.h). Over the samples that are `counted` and have all of their neighbours; not a
/// number where those are fewer than twenty for each coefficient that is fitted, or where either is zero.
double multiple_correlation(std::span<const Vec3> follower, std::span<const Vec3> leader, std::size_t reach,
                            const std::vector<bool>& counted);

}  // namespace osteomill
