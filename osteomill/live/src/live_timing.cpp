#include "osteomill/live/live_timing.h"

#include <algorithm>
#include <ctime>
#include <limits>
#include <type_traits>

namespace osteomill {

namespace {

constexpr Nanoseconds kNsPerS = 1'000'000'000;
constexpr Nanoseconds kSpin_ns = 100'000;
constexpr Nanoseconds kLate_ns = 1'000'000;
constexpr double kUsPerNs = 1e-3;

// Only one thread adds, so no atomic read-modify-write is needed.
template <typename T>
void add_to(std::atomic<T>& counter, std::type_identity_t<T> count) {
  counter.store(counter.load(std::memory_order_relaxed) + count, std::memory_order_relaxed);
}

}  // namespace

Nanoseconds monotonic_now_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return kNsPerS * now.tv_sec + now.tv_nsec;
}

NextDeadline next_deadline(Nanoseconds deadline_ns, Nanoseconds now_ns, Nanoseconds period_ns) noexcept {
  const Nanoseconds passed = (now_ns - deadline_ns) / period_ns;
  const int periods = passed < 2 ? 1 : static_cast<int>(passed);
  return {deadline_ns + periods * period_ns, periods};
}

Nanoseconds wait_until(Nanoseconds deadline_ns) {
  const Nanoseconds wake_ns = deadline_ns - kSpin_ns;
  if (monotonic_now_ns() < wake_ns) {
    const timespec wake{wake_ns / kNsPerS, wake_ns % kNsPerS};
    // A signal interrupts the sleep; sleep again until the deadline.
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) != 0) {
    }
  }
  Nanoseconds now_ns = monotonic_now_ns();
  while (now_ns < deadline_ns) now_ns = monotonic_now_ns();
  return now_ns;
}

void TimeHistogram::add(double time_us) noexcept {
  add_to(bins_[bin_of(time_us)], 1);
  add_to(count_, 1);
  if (time_us > max_us_.load(std::memory_order_relaxed)) {
    max_us_.store(time_us, std::memory_order_relaxed);
  }
}

std::size_t TimeHistogram::bin_of(double time_us) {
  if (!(time_us > 0)) return 0;
  if (time_us < 1e3) return static_cast<std::size_t>(time_us);
  if (time_us < 1e4) return kFineBins + static_cast<std::size_t>((time_us - 1e3) / 10);
  return kBins - 1;
}

double TimeHistogram::upper_end_us(std::size_t bin) {
  if (bin < kFineBins) return static_cast<double>(bin + 1);
  if (bin + 1 < kBins) return 1e3 + 10 * static_cast<double>(bin - kFineBins + 1);
  return std::numeric_limits<double>::infinity();
}

TimePercentiles TimeHistogram::percentiles() const {
  std::array<std::uint32_t, kBins> counts;
  std::uint64_t total = 0;
  for (std::size_t n = 0; n < kBins; ++n) total += counts[n] = bins_[n].load(std::memory_order_relaxed);
  TimePercentiles found;
  if (total == 0) return found;
  found.max_us = max_us_.load(std::memory_order_relaxed);
  const auto of_rank = [&](std::uint64_t rank) {
    std::uint64_t passed = 0;
    std::size_t bin = 0;
    while (bin + 1 < kBins && (passed += counts[bin]) < rank) ++bin;
    return std::min(upper_end_us(bin), found.max_us);
  };
  const auto at_share = [&](double share) {
    const auto [lower, upper] = percentile_ranks(share, total);
    return 0.5 * (of_rank(lower) + of_rank(upper));
  };
  found.p50_us = at_share(0.5);
  found.p99_us = at_share(0.99);
  found.p999_us = at_share(0.999);
  return found;
}

void LiveTiming::add(const TickTimes& times, const TickRecord& record) noexcept {
  const Nanoseconds lateness_ns = times.woke_ns - times.deadline_ns;
  if (lateness_.count() == 0) first_ns_.store(times.woke_ns, std::memory_order_relaxed);
  last_ns_.store(times.woke_ns, std::memory_order_relaxed);
  lateness_.add(kUsPerNs * static_cast<double>(lateness_ns));
  step_.add(record.compute_us);
  milling_.add(record.milling_us);
  const double busy_us = kUsPerNs * static_cast<double>(times.done_ns - times.woke_ns);
  tick_.add(busy_us);
  sustained_.add(busy_us);
  rate_hz_.store(sustained_.rate_hz(), std::memory_order_relaxed);
  if (lateness_ns > kLate_ns) add_to(late_ticks_, 1);
  if (times.periods > 1) add_to(missed_ticks_, static_cast<std::uint64_t>(times.periods - 1));
  const double woke_s = static_cast<double>(times.woke_ns) / static_cast<double>(kNsPerS);
  recent_ticks_per_s_.store(recent_.per_s(woke_s), std::memory_order_relaxed);
  recent_.count();
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
