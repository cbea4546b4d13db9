#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace osteomill {

/// The one meaning of a percentile in all that osteomill writes: the least value that at least this share
/// (0 to 1) of the values do not exceed, and where exactly that share does not exceed it, the mean of it and
/// the next (Hyndman and Fan 1996, type 2). So half gives the usual median, 0 the least value, 1 the
/// greatest. These are the ranks, counted from 1, of the two values whose mean it is.
struct PercentileRanks {
  std::size_t lower = 1;
  std::size_t upper = 1;
};
PercentileRanks percentile_ranks(double share, std::size_t count);

/// 0 for no values. Not for the haptic tick: it sorts a copy.
double percentile(std::vector<double> values, double share);

/// Median, 99th percentile and greatest of values. Zeros for no values.
struct Distribution {
  double median = 0;
  double p99 = 0;
  double max = 0;
};
Distribution distribution_of(std::vector<double> values);

/// The one meaning of `rate_hz` in all that osteomill writes: the rate that a loop held to `period_us` holds
/// when its ticks keep it busy as long as those added, a tick that is done early waiting for the next. So it
/// is at most the loop's own rate. Adding is safe in the haptic tick.
class HeldRate {
 public:
  explicit HeldRate(double period_us = 1000) : period_us_(period_us) {}
  void add(double busy_us) {
    sum_us_ += std::max(period_us_, busy_us);
    count_ += 1;
  }
  /// 0 where nothing was added.
  double rate_hz() const { return count_ > 0 ? 1e6 * count_ / sum_us_ : 0; }

 private:
  double period_us_;
  double sum_us_ = 0;
  double count_ = 0;
};

}  // namespace osteomill
