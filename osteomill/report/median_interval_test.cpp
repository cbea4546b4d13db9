#include "osteomill/report/median_interval.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

// 1, 2, ..., n, last first.
std::vector<double> ranks(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.rbegin(), values.rend(), 1.0);
  return values;
}

// Ranks of the limits and exact coverage, as in the textbooks' tables of distribution-free intervals for the
// median.
TEST(MedianInterval, RanksAreThoseOfTheBinomialTables) {
  struct Known {
    std::size_t n;
    double low, high, coverage;
  };
  for (const Known& known :
       {Known{6, 1, 6, 0.96875}, Known{7, 1, 7, 0.984375}, Known{8, 1, 8, 0.9921875},
        Known{9, 2, 8, 0.9609375}, Known{10, 2, 9, 0.978515625}, Known{12, 3, 10, 0.9614},
        Known{15, 4, 12, 0.9648}, Known{20, 6, 15, 0.9586}, Known{25, 8, 18, 0.9567}}) {
    const MedianInterval interval = median_interval(ranks(known.n));
    EXPECT_EQ(interval.low, known.low) << known.n;
    EXPECT_EQ(interval.high, known.high) << known.n;
    EXPECT_NEAR(interval.coverage, known.coverage, 5e-5) << known.n;
    EXPECT_EQ(interval.median, 0.5 * static_cast<double>(known.n + 1));
    EXPECT_FALSE(interval.is_range);
  }
}

TEST(MedianInterval, TooFewValuesGiveTheirRangeAndSaySo) {
  for (const std::size_t n : {1u, 2u, 3u, 5u}) {
    const MedianInterval interval = median_interval(ranks(n));
    EXPECT_TRUE(interval.is_range) << n;
    EXPECT_EQ(interval.low, 1) << n;
    EXPECT_EQ(interval.high, static_cast<double>(n)) << n;
    EXPECT_NEAR(interval.coverage, 1 - std::pow(0.5, static_cast<double>(n) - 1), 1e-12) << n;
  }
  EXPECT_EQ(median_interval({}).median, 0);
}

TEST(MedianInterval, ACoverageThatIsMetExactlyIsEnough) {
  // 1 - 2 / 2^3.
  EXPECT_FALSE(median_interval(ranks(3), 0.75).is_range);
  EXPECT_TRUE(median_interval(ranks(3), 0.7501).is_range);
}

}  // namespace
}  // namespace osteomill
