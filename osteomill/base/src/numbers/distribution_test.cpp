#include "osteomill/base/distribution.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

std::vector<double> one_to(std::size_t count) {
  std::vector<double> values(count);
  std::iota(values.begin(), values.end(), 1.0);
  std::reverse(values.begin(), values.end());
  return values;
}

TEST(Distribution, MatchesKnownMedianP99AndMaximum) {
  const Distribution d = distribution_of(one_to(1000));
  EXPECT_DOUBLE_EQ(d.median, 500.5);
  EXPECT_DOUBLE_EQ(d.p99, 990.5);
  EXPECT_DOUBLE_EQ(d.max, 1000);
  EXPECT_DOUBLE_EQ(distribution_of({3, 1, 2}).median, 2);
  EXPECT_DOUBLE_EQ(distribution_of({7}).p99, 7);
  EXPECT_DOUBLE_EQ(distribution_of({}).max, 0);
}

// Compares with integer arithmetic: the smallest k with 1000 k >= thousandths * n; if both sides are equal,
// also its successor.
TEST(Percentile, RanksAreExactForUpTo2000Values) {
  for (std::size_t n = 1; n <= 2000; ++n) {
    for (const std::size_t thousandths : {1u, 500u, 950u, 990u, 998u, 999u, 1000u}) {
      const std::size_t lower = (thousandths * n + 999) / 1000;
      const std::size_t upper = thousandths * n % 1000 == 0 ? std::min(lower + 1, n) : lower;
      const PercentileRanks ranks = percentile_ranks(static_cast<double>(thousandths) / 1000, n);
      ASSERT_EQ(ranks.lower, lower) << thousandths << " of " << n;
      ASSERT_EQ(ranks.upper, upper) << thousandths << " of " << n;
    }
  }
}

TEST(Percentile, EqualsTheMedianAtOneHalf) {
  for (const std::vector<double>& values : {one_to(7), one_to(8), std::vector<double>{3, 1}, {5}}) {
    EXPECT_EQ(percentile(values, 0.5), distribution_of(values).median);
  }
  EXPECT_EQ(percentile(one_to(10), 0.5), 5.5);
}

TEST(Percentile, EqualsTheMinimumAtZeroAndTheMaximumAtOne) {
  EXPECT_EQ(percentile(one_to(10), 0), 1);
  EXPECT_EQ(percentile(one_to(10), 1), 10);
  EXPECT_EQ(percentile(one_to(10), 0.91), 10);
  EXPECT_EQ(percentile({}, 0.5), 0);
}

TEST(SustainedRate, DropsOnlyForTicksLongerThanThePeriod) {
  const auto rate_of = [](std::initializer_list<double> busy_us, double period_us) {
    SustainedRate rate(period_us);
    for (const double busy : busy_us) rate.add(busy);
    return rate.rate_hz();
  };
  EXPECT_DOUBLE_EQ(rate_of({10, 999, 0}, 1000), 1000);
  EXPECT_DOUBLE_EQ(rate_of({10, 3000}, 1000), 500);
  EXPECT_DOUBLE_EQ(rate_of({10, 1500}, 500), 1000);
  EXPECT_EQ(rate_of({}, 1000), 0);
}

}  // namespace
}  // namespace osteomill
