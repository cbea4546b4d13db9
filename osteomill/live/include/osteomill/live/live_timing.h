#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "osteomill/base/distribution.h"
#include "osteomill/base/recent_rate.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// Nanoseconds of the system's monotonic clock.
using Nanoseconds = std::int64_t;

/// Returns the time of that clock. Safe in the haptic tick.
Nanoseconds monotonic_now_ns() noexcept;

/// The deadline `periods` after an earlier one, met or not (next_deadline()).
struct NextDeadline {
  Nanoseconds deadline_ns;
  int periods;
};

/// Returns the next deadline of a loop of `period_ns`, at `now_ns` when the tick of `deadline_ns` is done:
/// one period on, or, if that lies a whole period or more in the past, the last one that has passed. Ticks
/// that were missed are not made up for: they would come in a burst, faster than any device takes them.
NextDeadline next_deadline(Nanoseconds deadline_ns, Nanoseconds now_ns, Nanoseconds period_ns) noexcept;

/// Sleeps until 100 us before the deadline (clock_nanosleep to an absolute time), then looks at the clock
/// until it has come: waking from sleep is what is late. Returns the time at which it returns.
Nanoseconds wait_until(Nanoseconds deadline_ns);

/// The time that a live session keeps: the system's, or one that a test sets.
struct TickClock {
  std::function<Nanoseconds()> now_ns = monotonic_now_ns;
  std::function<Nanoseconds(Nanoseconds deadline_ns)> wait_until = osteomill::wait_until;
};

/// Percentiles (distribution.h) of a histogram of times, microseconds. A time counts as the upper end
/// of the bin it falls into (1 us wide up to 1 ms, 10 us up to 10 ms), or as the greatest time, if that is
/// less. All zero if none was counted.
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
  void add(double time_us) noexcept;
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

/// The times at which a tick was due, its thread woke for it, and it was done.
struct TickTimes {
  Nanoseconds deadline_ns = 0;
  Nanoseconds woke_ns = 0;
  Nanoseconds done_ns = 0;
  /// Periods since the deadline before: more than 1 if ticks were missed.
  int periods = 1;
};

/// Figures of how well a live session keeps its time.
struct TimingSummary {
  std::uint64_t ticks = 0;
  /// The rate that the ticks' work allows a loop of this period (SustainedRate), whether they woke in time or
  /// not.
  double rate_hz = 0;
  /// Counted by the clock: over the whole time, and over the last second that was completed (0 before).
  double ticks_per_s = 0;
  double recent_ticks_per_s = 0;
  /// From the deadline to the waking.
  TimePercentiles lateness;
  /// Ticks that woke more than 1 ms late, and deadlines that passed without a tick.
  std::uint64_t late_ticks = 0;
  std::uint64_t missed_ticks = 0;
  /// The algorithm's step; milling with all that follows the volume; the whole tick from waking to done.
  TimePercentiles step;
  TimePercentiles milling;
  TimePercentiles tick;
};

/// Counts ticks' times. One thread adds, safely in the haptic tick; any thread reads meanwhile.
class LiveTiming {
 public:
  explicit LiveTiming(double period_us = 1000) : sustained_(period_us) {}

  void add(const TickTimes& times, const TickRecord& record) noexcept;
  TimingSummary summary() const;

 private:
  TimeHistogram lateness_;
  TimeHistogram step_;
  TimeHistogram milling_;
  TimeHistogram tick_;
  std::atomic<std::uint64_t> late_ticks_{0};
  std::atomic<std::uint64_t> missed_ticks_{0};
  std::atomic<Nanoseconds> first_ns_{0};
  std::atomic<Nanoseconds> last_ns_{0};
  std::atomic<double> rate_hz_{0};
  std::atomic<double> recent_ticks_per_s_{0};
  // The adding thread's own.
  SustainedRate sustained_;
  RecentRate recent_;
};

}  // namespace osteomill
