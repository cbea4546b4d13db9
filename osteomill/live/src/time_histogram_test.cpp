#include <gtest/gtest.h>

#include "osteomill/live/live_timing.h"

namespace osteomill {
namespace {

TEST(TimeHistogram, ReportsZeroWithoutSamples) {
  const TimeHistogram none;
  EXPECT_EQ(none.percentiles().p50_us, 0);
  EXPECT_EQ(none.percentiles().max_us, 0);
}

TEST(TimeHistogram, PercentilesMatchKnownTimes) {
  TimeHistogram times;
  for (int n = 0; n < 1000; ++n) times.add(n + 0.5);
  const TimePercentiles found = times.percentiles();
  EXPECT_EQ(found.p50_us, 500.5);
  EXPECT_EQ(found.p99_us, 990.5);
  EXPECT_EQ(found.p999_us, 999.25);
  EXPECT_EQ(found.max_us, 999.5);
}

TEST(TimeHistogram, BinsLongTimesCoarselyAndReportsTheLongestExactly) {
  TimeHistogram times;
  for (int n = 0; n < 98; ++n) times.add(3);
  times.add(2345);
  times.add(123456);
  const TimePercentiles found = times.percentiles();
  EXPECT_EQ(found.p50_us, 4);
  EXPECT_EQ(found.p99_us, 0.5 * (2350 + 123456));
  EXPECT_EQ(found.p999_us, 123456);
  EXPECT_EQ(times.count(), 100u);
}

}  // namespace
}  // namespace osteomill
