#include "osteomill/base/recent_rate.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(RecentRate, IsUpdatedOnceASecondHasPassed) {
  RecentRate rate;
  EXPECT_EQ(rate.per_s(100), 0);
  for (int n = 0; n < 50; ++n) rate.count();
  EXPECT_EQ(rate.per_s(100.9), 0);
  EXPECT_EQ(rate.per_s(101.25), 40);
  rate.count();
  EXPECT_EQ(rate.per_s(102), 40);
  EXPECT_EQ(rate.per_s(102.25), 1);
  EXPECT_EQ(rate.per_s(103.25), 0);
}

// Ignores events counted before the first call.
TEST(RecentRate, IgnoresEventsBeforeTheFirstQuery) {
  RecentRate rate;
  for (int n = 0; n < 50; ++n) rate.count();
  EXPECT_EQ(rate.per_s(0), 0);
  EXPECT_EQ(rate.per_s(1), 0);
}

}  // namespace
}  // namespace osteomill
