#include "osteomill/live/live_timing.h"

namespace osteomill {

namespace {

constexpr double kUsPerNs = 1e-3;
constexpr Nanoseconds kNsPerS = 1'000'000'000;
constexpr Nanoseconds kLate_ns = 1'000'000;

void add_to(std::atomic<std::uint64_t>& counter, std::uint64_t count) {
  counter.store(counter.load(std::memory_order_relaxed) + count, std::memory_order_relaxed);
}

}  // namespace

void LiveTiming::add(const TickTimes& times, const TickRecord& record) {
  const Nanoseconds lateness_ns = times.woke_ns - times.deadline_ns;
  if (lateness_.count() == 0) first_ns_.store(times.woke_ns, std::memory_order_relaxed);
  last_ns_.store(times.woke_ns, std::memory_order_relaxed);
  lateness_.add(kUsPerNs * static_cast<double>(lateness_ns));
  step_.add(record.compute_us);
  milling_.add(record.milling_us);
  const double busy_us = kUsPerNs * static_cast<double>(times.done_ns - times.woke_ns);
  tick_.add(busy_us);
  held_.add(busy_us);
  rate_hz_.store(held_.rate_hz(), std::memory_order_relaxed);
  if (lateness_ns > kLate_ns) add_to(late_ticks_, 1);
  if (times.periods > 1) add_to(missed_ticks_, static_cast<std::uint64_t>(times.periods - 1));
  count_recent(times.woke_ns);
}

void LiveTiming::count_recent(Nanoseconds woke_ns) {
  if (second_began_ns_ == 0) second_began_ns_ = woke_ns;
  const Nanoseconds passed_ns = woke_ns - second_began_ns_;
  if (passed_ns >= kNsPerS) {
    const double passed_s = static_cast<double>(passed_ns) / static_cast<double>(kNsPerS);
    recent_ticks_per_s_.store(ticks_this_second_ / passed_s, std::memory_order_relaxed);
    second_began_ns_ = woke_ns;
    ticks_this_second_ = 0;
  }
  ++ticks_this_second_;
}

TimingSummary LiveTiming::summary() const {
  TimingSummary found;
  found.ticks = lateness_.count();
  const auto passed_ns = static_cast<double>(last_ns_.load(std::memory_order_relaxed) -
                                             first_ns_.load(std::memory_order_relaxed));
  if (found.ticks > 1 && passed_ns > 0) {
    found.ticks_per_s = static_cast<double>(found.ticks - 1) * static_cast<double>(kNsPerS) / passed_ns;
  }
  found.rate_hz = rate_hz_.load(std::memory_order_relaxed);
  found.recent_ticks_per_s = recent_ticks_per_s_.load(std::memory_order_relaxed);
  found.lateness = lateness_.percentiles();
  found.late_ticks = late_ticks_.load(std::memory_order_relaxed);
  found.missed_ticks = missed_ticks_.load(std::memory_order_relaxed);
  found.step = step_.percentiles();
  found.milling = milling_.percentiles();
  found.tick = tick_.percentiles();
  return found;
}

}  // namespace osteomill
