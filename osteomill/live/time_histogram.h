#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace osteomill {

/// Percentiles (numbers/distribution.h) of a histogram of times, microseconds. A time counts as the upper end
/// of the bin it falls into (1 us wide up to 1 ms, 10 us up to 10 ms), or as the greatest time, where that is
/// less. All zero where none was
/// counted.
struct TimePercentiles {
  double p50_us = 0;
  double p99_us = 0;
  double p999_us = 0;
  double max_us = 0;
};

/// Counts times. One thread adds, safely in the haptic tick; any thread reads meanwhile, and may see some of
/// the newest not yet.
class TimeHistogram {
 public:
  /// Times below zero count as zero.
  void add(double time_us);
  TimePercentiles percentiles() const;
  std::uint64_t count() const { return count_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t kFineBins = 1000;
  static constexpr std::size_t kCoarseBins = 900;
  static constexpr std::size_t kBins = kFineBins + kCoarseBins + 1;

  static std::size_t bin_of(double time_us);
  static double upper_end_us(std::size_t bin);

  std::array<std::atomic<std::uint32_t>, kBins> bins_{};
  std::atomic<std::uint64_t> count_{0};
  std::atomic<double> max_us_{0};
};

}  // namespace osteomill
