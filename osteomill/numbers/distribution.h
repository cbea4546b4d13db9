#pragma once

#include <cstddef>
#include <vector>

namespace osteomill {

/// How many of `count` ascending values make up `share` of them (0 to 1): the nearest rank, counted from 1.
std::size_t nearest_rank(double share, std::size_t count);

/// The smallest value that at least this share of the values do not exceed (nearest rank, so always one of
/// them): 0 gives the least, 1 the greatest. 0 for no values. Not for the haptic tick: it sorts a copy.
double percentile(std::vector<double> values, double share);

/// Median (mean of the two middle values of an even number), 99th percentile and greatest of values. Zeros
/// for no values.
struct Distribution {
  double median = 0;
  double p99 = 0;
  double max = 0;
};
Distribution distribution_of(std::vector<double> values);

}  // namespace osteomill
