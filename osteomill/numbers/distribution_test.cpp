#include "osteomill/numbers/distribution.h"

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

TEST(Distribution, KnownValues) {
  const Distribution d = distribution_of(one_to(1000));
  EXPECT_DOUBLE_EQ(d.median, 500.5);
  EXPECT_DOUBLE_EQ(d.p99, 990);
  EXPECT_DOUBLE_EQ(d.max, 1000);
  EXPECT_DOUBLE_EQ(distribution_of({3, 1, 2}).median, 2);
  EXPECT_DOUBLE_EQ(distribution_of({7}).p99, 7);
  EXPECT_DOUBLE_EQ(distribution_of({}).max, 0);
}

// Against counting in whole numbers: the least k with 1000 k >= share in thousandths * n.
TEST(Percentile, IsTheNearestRankOfEveryNumberOfValues) {
  for (std::size_t n = 1; n <= 2000; ++n) {
    for (const std::size_t thousandths : {1u, 500u, 950u, 990u, 998u, 999u, 1000u}) {
      const std::size_t rank = (thousandths * n + 999) / 1000;
      ASSERT_EQ(nearest_rank(static_cast<double>(thousandths) / 1000, n), rank) << thousandths << " of " << n;
    }
  }
}

TEST(Percentile, EndsAreTheLeastAndTheGreatest) {
  EXPECT_EQ(percentile(one_to(10), 0), 1);
  EXPECT_EQ(percentile(one_to(10), 1), 10);
  EXPECT_EQ(percentile(one_to(10), 0.5), 5);
  EXPECT_EQ(percentile(one_to(10), 0.91), 10);
  EXPECT_EQ(percentile({}, 0.5), 0);
}

}  // namespace
}  // namespace osteomill
