#pragma once

#include <atomic>
#include <cstdint>

#include "osteomill/live/tick_clock.h"
#include "osteomill/live/time_histogram.h"
#include "osteomill/numbers/distribution.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// When one tick was due, when its thread woke for it, and when it was done.
struct TickTimes {
  Nanoseconds deadline_ns = 0;
  Nanoseconds woke_ns = 0;
  Nanoseconds done_ns = 0;
  /// Periods since the deadline before: more than 1 where ticks were missed.
  int periods = 1;
};

/// How well a live session keeps its time.
struct TimingSummary {
  std::uint64_t ticks = 0;
  /// What the ticks' work allows a loop of this period (HeldRate), whether they woke in time or not.
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
  void add(const TickTimes& times, const TickRecord& record);
  TimingSummary summary() const;

 private:
  void count_recent(Nanoseconds woke_ns);

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
  HeldRate held_;
  Nanoseconds second_began_ns_ = 0;
  int ticks_this_second_ = 0;
};

}  // namespace osteomill
