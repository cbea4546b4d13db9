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

/// Returns the present time of that clock. Safe in the haptic tick.
Nanoseconds monotonic_now_ns() noexcept;

/// Result of next_deadline(): `periods` after the previous deadline, which was met or missed.
struct NextDeadline {
  Nanoseconds deadline_ns;
  int periods;
};

/// Returns the next deadline of a loop of `period_ns` after the tick due at `deadline_ns`, which is done at
/// `now_ns`: one period later or, if that is already a whole period or more ago, the latest deadline that has
/// passed. Missed ticks are not made up for: they would come in a burst, faster than any device accepts them.
NextDeadline next_deadline(Nanoseconds deadline_ns, Nanoseconds now_ns, Nanoseconds period_ns) noexcept;

/// Sleeps until 100 us before the deadline (clock_nanosleep to an absolute time), then polls the clock,
/// because the wake-up from sleep is what causes lateness. Returns the time of its return.
Nanoseconds wait_until(Nanoseconds deadline_ns);

/// Clock of a live session: the system's, or a test's.
struct TickClock {
  std::function<Nanoseconds()> now_ns = monotonic_now_ns;
  std::function<Nanoseconds(Nanoseconds deadline_ns)> wait_until = osteomill::wait_until;
};

/// Percentiles (distribution.h) of a histogram of times, microseconds. A time counts as the upper end of its
/// bin (1 us wide up to 1 ms, 10 us up to 10 ms), or as the maximum if that is less. All zero if the
/// histogram is empty.
struct TimePercentiles {
  double p50_us = 0;
  double p99_us = 0;
  double p999_us = 0;
  double max_us = 0;
};

/// Histogram of times. One thread adds, safely in the haptic tick; any thread may read meanwhile, possibly
/// without the newest times.
class TimeHistogram {
 public:
  /// Clamps negative times to zero.
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

/// Times of a tick: its deadline, the wake-up of its thread, and its end.
struct TickTimes {
  Nanoseconds deadline_ns = 0;
  Nanoseconds woke_ns = 0;
  Nanoseconds done_ns = 0;
  /// Periods since the previous deadline: more than 1 if ticks were missed.
  int periods = 1;
};

/// Timing statistics of a live session.
struct TimingSummary {
  std::uint64_t ticks = 0;
  /// Rate that a loop of this period could sustain given the ticks' work (SustainedRate), whether they woke
  /// in time or not.
  double rate_hz = 0;
  /// Measured by the clock: mean over the whole time, and over the last full second (0 before that).
  double ticks_per_s = 0;
  double recent_ticks_per_s = 0;
  /// Delay from deadline to wake-up.
  TimePercentiles lateness;
  /// Number of ticks that woke more than 1 ms late, and of deadlines without a tick.
  std::uint64_t late_ticks = 0;
  std::uint64_t missed_ticks = 0;
  /// Time of the algorithm's step; of milling with everything that follows the volume; of the whole tick from
  /// wake-up to end.
  TimePercentiles step;
  TimePercentiles milling;
  TimePercentiles tick;
};

/// Collects the times of ticks. One thread adds, safely in the haptic tick; any thread may read meanwhile.
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
  // Used by the adding thread only.
  SustainedRate sustained_;
  RecentRate recent_;
};

}  // namespace osteomill
