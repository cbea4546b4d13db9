#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace osteomill {

/// The ranks, counted from 1, of the two values whose mean is a percentile. Every percentile in osteomill is
/// the smallest value that at least a share (0 to 1) of the values do not exceed, or, if exactly that share
/// does not exceed it, the mean of that value and the next (Hyndman and Fan 1996, type 2). So 0.5 gives the
/// usual median, 0 the minimum, 1 the maximum.
struct PercentileRanks {
  std::size_t lower = 1;
  std::size_t upper = 1;
};
/// Returns the ranks of the percentile for a share (0 to 1) of `count` values.
PercentileRanks percentile_ranks(double share, std::size_t count);

/// Returns the percentile of the values for this share; 0 if there are no values. Not for the haptic tick:
/// sorts a copy.
double percentile(std::vector<double> values, double share);

/// Median, 99th percentile and maximum of a set of values.
struct Distribution {
  double median = 0;
  double p99 = 0;
  double max = 0;
};
/// Returns the distribution of the values; zeros if there are none. Not for the haptic tick: sorts a copy.
Distribution distribution_of(std::vector<double> values);

/// Computes `rate_hz` as osteomill's files define it: the rate of a loop with the period `period_us` whose
/// ticks are busy for the added times. A tick that finishes early waits for the end of its period, so the
/// rate never exceeds the loop's nominal rate. Adding is safe in the haptic tick.
class SustainedRate {
 public:
  explicit SustainedRate(double period_us = 1000) : period_us_(period_us) {}
  void add(double busy_us) {
    sum_us_ += std::max(period_us_, busy_us);
    count_ += 1;
  }
  /// Returns 0 if nothing was added.
  double rate_hz() const { return count_ > 0 ? 1e6 * count_ / sum_us_ : 0; }

 private:
  double period_us_;
  double sum_us_ = 0;
  double count_ = 0;
};

}  // namespace osteomill
