#include <gtest/gtest.h>

#include "osteomill/live/live_timing.h"

namespace osteomill {
namespace {

constexpr Nanoseconds kMs = 1'000'000;

TEST(TickClock, SchedulesTheNextPeriodAfterATickInTime) {
  const NextDeadline next = next_deadline(10 * kMs, 10 * kMs + 300'000, kMs);
  EXPECT_EQ(next.deadline_ns, 11 * kMs);
  EXPECT_EQ(next.periods, 1);
}

TEST(TickClock, SchedulesTheNextTickAtOnceAfterAShortOverrun) {
  const NextDeadline next = next_deadline(10 * kMs, 11 * kMs + 900'000, kMs);
  EXPECT_EQ(next.deadline_ns, 11 * kMs);
  EXPECT_EQ(next.periods, 1);
}

TEST(TickClock, SkipsAndCountsMissedPeriodsAndKeepsTheGrid) {
  const NextDeadline next = next_deadline(10 * kMs, 13 * kMs + 400'000, kMs);
  EXPECT_EQ(next.deadline_ns, 13 * kMs);
  EXPECT_EQ(next.periods, 3);
}

TEST(TickClock, NeverWakesBeforeTheDeadline) {
  for (const Nanoseconds ahead_ns : {Nanoseconds{20'000}, Nanoseconds{3 * kMs}}) {
    const Nanoseconds deadline_ns = monotonic_now_ns() + ahead_ns;
    const Nanoseconds woke_ns = wait_until(deadline_ns);
    EXPECT_GE(woke_ns, deadline_ns);
    EXPECT_GE(monotonic_now_ns(), woke_ns);
  }
}

TEST(TickClock, ReturnsWakeTimeNotDeadlineWhenDeadlineHasPassed) {
  const Nanoseconds before_ns = monotonic_now_ns();
  EXPECT_GE(wait_until(before_ns - 5 * kMs), before_ns);
}

}  // namespace
}  // namespace osteomill
