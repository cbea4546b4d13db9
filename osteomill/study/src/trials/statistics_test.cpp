#include "trials/statistics.h"

#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {

namespace {

// Returns differences 1, 2, ..., n, of which the negative ones have ranks that sum to `sum`.
std::vector<double> with_negative_sum(std::size_t n, std::size_t sum) {
  std::vector<double> differences(n);
  for (std::size_t rank = n; rank >= 1; --rank) {
    const bool negative = rank <= sum;
    if (negative) sum -= rank;
    differences[rank - 1] = (negative ? -1.0 : 1.0) * static_cast<double>(rank);
  }
  EXPECT_EQ(sum, 0u);
  return differences;
}

// Largest sum that is significant at 5 %, two-sided: Wilcoxon and Wilcox (1964), table 2, as reprinted in
// textbooks.
TEST(SignedRank, MatchesTabulatedCriticalValues) {
  const struct {
    std::size_t n, critical;
  } known[] = {{6, 0},   {7, 2},   {8, 3},   {9, 5},   {10, 8},  {11, 10}, {12, 13},
               {13, 17}, {14, 21}, {15, 25}, {16, 29}, {20, 52}, {25, 89}};
  for (const auto& row : known) {
    const SignedRank at = signed_rank(with_negative_sum(row.n, row.critical));
    EXPECT_EQ(at.negative, static_cast<double>(row.critical)) << row.n;
    EXPECT_LE(at.p, 0.05) << row.n;
    EXPECT_GT(signed_rank(with_negative_sum(row.n, row.critical + 1)).p, 0.05) << row.n;
  }
}

TEST(SignedRank, MatchesKnownPValues) {
  // 2 * (number of subsets of 1..n with at most this sum) / 2^n, counted by hand.
  EXPECT_DOUBLE_EQ(signed_rank(with_negative_sum(5, 0)).p, 2.0 / 32);
  EXPECT_DOUBLE_EQ(signed_rank(with_negative_sum(5, 3)).p, 2.0 * 5 / 32);
  EXPECT_DOUBLE_EQ(signed_rank(with_negative_sum(10, 8)).p, 2.0 * 25 / 1024);
  // R: wilcox.test(c(1.83,0.50,1.62,2.48,1.68,1.88,1.55,3.06,1.30),
  //                c(0.878,0.647,0.598,2.05,1.06,1.29,1.06,3.14,1.29), paired = TRUE), V = 40, p = 0.03906.
  const std::vector<double> first{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
  const std::vector<double> second{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
  std::vector<double> differences;
  for (std::size_t n = 0; n < first.size(); ++n) differences.push_back(first[n] - second[n]);
  const SignedRank test = signed_rank(differences);
  EXPECT_EQ(test.positive, 40);
  EXPECT_DOUBLE_EQ(test.p, 0.0390625);
}

TEST(SignedRank, DropsZerosAndAveragesRanksOfTies) {
  EXPECT_EQ(signed_rank(std::vector<double>{0, 0}).p, 1);
  EXPECT_EQ(signed_rank({}).p, 1);
  const SignedRank test = signed_rank(std::vector<double>{0, 2, -2, 2, 2});
  EXPECT_EQ(test.pairs, 4u);
  EXPECT_EQ(test.positive, 7.5);
  EXPECT_EQ(test.negative, 2.5);
  // One or no negative sign of four: 5 of 16 ways.
  EXPECT_DOUBLE_EQ(test.p, 2.0 * 5 / 16);
}

TEST(SignedRank, ReturnsMinPIfAllDifferencesArePositive) {
  for (const std::size_t n : {1u, 3u, 8u, 30u, 200u}) {
    EXPECT_DOUBLE_EQ(signed_rank(with_negative_sum(n, 0)).p, min_p(n)) << n;
  }
  EXPECT_EQ(min_p(3), 0.25);
  EXPECT_EQ(min_p(0), 1);
}

TEST(SignedRank, MatchesNormalApproximationForManyPairs) {
  const std::vector<double> half = with_negative_sum(100, 2525);
  EXPECT_NEAR(signed_rank(half).p, 1, 0.01);
  // The normal approximation: mean 2525, variance 100 * 101 * 201 / 24.
  EXPECT_NEAR(signed_rank(with_negative_sum(100, 1955)).p, 0.05, 0.001);
}

// Holm (1979); the example of R's p.adjust(c(0.01, 0.02, 0.03), "holm").
TEST(Holm, MatchesPAdjustOfRAndCapsAtOne) {
  EXPECT_EQ(holm_corrected(std::vector<double>{0.03, 0.01, 0.02}), (std::vector<double>{0.04, 0.03, 0.04}));
  EXPECT_EQ(holm_corrected(std::vector<double>{0.5, 0.6}), (std::vector<double>{1.0, 1.0}));
  EXPECT_TRUE(holm_corrected({}).empty());
}

}  // namespace

namespace {

// Returns n, ..., 2, 1.
std::vector<double> ranks(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.rbegin(), values.rend(), 1.0);
  return values;
}

// Ranks of the limits and exact coverage, as in the textbooks' tables of distribution-free intervals for the
// median.
TEST(MedianInterval, MatchesTabulatedRanksAndCoverage) {
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

TEST(MedianInterval, ReturnsFlaggedRangeIfValuesAreTooFew) {
  for (const std::size_t n : {1u, 2u, 3u, 5u}) {
    const MedianInterval interval = median_interval(ranks(n));
    EXPECT_TRUE(interval.is_range) << n;
    EXPECT_EQ(interval.low, 1) << n;
    EXPECT_EQ(interval.high, static_cast<double>(n)) << n;
    EXPECT_NEAR(interval.coverage, 1 - std::pow(0.5, static_cast<double>(n) - 1), 1e-12) << n;
  }
  EXPECT_EQ(median_interval({}).median, 0);
}

TEST(MedianInterval, AcceptsExactlyTheRequestedCoverage) {
  // 1 - 2 / 2^3.
  EXPECT_FALSE(median_interval(ranks(3), 0.75).is_range);
  EXPECT_TRUE(median_interval(ranks(3), 0.7501).is_range);
}

}  // namespace

}  // namespace osteomill
