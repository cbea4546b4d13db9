#include "osteomill/live/live_timing.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

constexpr Nanoseconds kMs = 1'000'000;
constexpr Nanoseconds kUs = 1'000;

TickRecord record_of(double compute_us, double milling_us) {
  TickRecord record;
  record.compute_us = compute_us;
  record.milling_us = milling_us;
  return record;
}

// 1001 ticks a millisecond apart, the nth of every ten woken n * 10 us late.
TEST(LiveTiming, SummaryMatchesKnownDeadlines) {
  LiveTiming timing;
  for (int n = 0; n <= 1000; ++n) {
    const Nanoseconds deadline_ns = 50 * kMs + n * kMs;
    const Nanoseconds woke_ns = deadline_ns + (n % 10) * 10 * kUs;
    timing.add({deadline_ns, woke_ns, woke_ns + 80 * kUs, 1}, record_of(30.5, 20.5));
  }
  const TimingSummary found = timing.summary();
  EXPECT_EQ(found.ticks, 1001u);
  EXPECT_NEAR(found.rate_hz, 1000, 1e-9);
  EXPECT_NEAR(found.ticks_per_s, 1000, 1e-9);
  EXPECT_NEAR(found.recent_ticks_per_s, 1000, 1e-9);
  EXPECT_NEAR(found.lateness.p50_us, 40, 1);
  EXPECT_NEAR(found.lateness.p99_us, 90, 1);
  EXPECT_EQ(found.lateness.max_us, 90);
  EXPECT_EQ(found.late_ticks, 0u);
  EXPECT_EQ(found.missed_ticks, 0u);
  EXPECT_EQ(found.step.p50_us, 30.5);
  EXPECT_EQ(found.milling.p99_us, 20.5);
  EXPECT_EQ(found.tick.max_us, 80);
}

// Every tick ends 2.5 ms after its deadline, so that only every second deadline gets a tick.
TEST(LiveTiming, ReportsActualRateWhenTicksMissDeadlines) {
  LiveTiming timing;
  for (int n = 0; n <= 500; ++n) {
    const Nanoseconds deadline_ns = n * 2 * kMs;
    timing.add({deadline_ns, deadline_ns + 1200 * kUs, deadline_ns + 2500 * kUs, n == 0 ? 1 : 2}, {});
  }
  const TimingSummary found = timing.summary();
  EXPECT_NEAR(found.ticks_per_s, 500, 1e-9);
  // Each tick works for 1.3 ms; its late wake-up does not count.
  EXPECT_NEAR(found.rate_hz, 1e3 / 1.3, 1e-9);
  EXPECT_EQ(found.late_ticks, 501u);
  EXPECT_EQ(found.missed_ticks, 500u);
}

TEST(LiveTiming, ReportsTheRateOfA4000HzLoop) {
  LiveTiming timing(250);
  for (int n = 0; n <= 400; ++n) {
    const Nanoseconds deadline_ns = n * 250 * kUs;
    timing.add({deadline_ns, deadline_ns, deadline_ns + 80 * kUs, 1}, {});
  }
  EXPECT_NEAR(timing.summary().rate_hz, 4000, 1e-9);
  EXPECT_NEAR(timing.summary().ticks_per_s, 4000, 1e-9);
}

TEST(LiveTiming, ReportsZeroRateWithoutTicks) {
  EXPECT_EQ(LiveTiming().summary().rate_hz, 0);
  EXPECT_EQ(LiveTiming().summary().ticks, 0u);
}

}  // namespace
}  // namespace osteomill
