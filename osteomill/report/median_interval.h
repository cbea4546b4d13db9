#pragma once

#include <span>

namespace osteomill {

/// The median of a sample, and an interval that covers the median of what the sample was drawn from.
struct MedianInterval {
  double median = 0;
  double low = 0;
  double high = 0;
  /// The exact chance that such an interval covers the median, whatever the distribution.
  double coverage = 0;
  /// The sample is too small for the chance that was asked for: the interval is its whole range.
  bool is_range = false;
};

/// The interval between two order statistics, the k-th from below and the k-th from above, with the greatest
/// k whose coverage, 1 - 2 P(Binomial(n, 1/2) < k), is at least `coverage` (a share in (0, 1)). Six values
/// are the fewest that give 95 %. Zeros for no values.
MedianInterval median_interval(std::span<const double> values, double coverage = 0.95);

}  // namespace osteomill
