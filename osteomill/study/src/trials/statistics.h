#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace osteomill {

/// The level below which a difference is called significant.
inline constexpr double kSignificance = 0.05;

/// Wilcoxon's signed-rank test of paired differences.
struct SignedRank {
  /// Differences that are not zero; only they are ranked.
  std::size_t pairs = 0;
  /// The sums of the ranks of the positive and of the negative differences.
  double positive = 0;
  double negative = 0;
  /// Two-sided and exact: the share of all 2^pairs ways to give the ranks signs whose smaller sum is at most
  /// the one seen. 1 if there are no differences.
  double p = 1;
};

/// Differences of the same size share the mean of their ranks, and the distribution is the one of those
/// ranks. Takes time in proportion to the cube of the number of differences (0.01 s for 200).
SignedRank signed_rank(std::span<const double> differences);

/// "p = 0.012", "p < 0.001".
std::string p_text(double p);

/// Returns the least p that this test can give with n differences: 2^(1 - n).
double min_p(std::size_t differences);

/// Holm's correction for testing several things at once (1979): p-values in the same order, each of which may
/// be held against the level of significance as if it were alone.
std::vector<double> holm_corrected(std::span<const double> p);

/// Returns the chance of fewer than k heads in n tosses of a coin: P(Binomial(n, 1/2) < k).
double chance_of_fewer_heads(std::size_t k, std::size_t tosses);

/// The median of a sample, and an interval that covers the median of what the sample was drawn from.
struct MedianInterval {
  double median = 0;
  double low = 0;
  double high = 0;
  /// The exact chance that such an interval covers the median, whatever the distribution.
  double coverage = 0;
  /// The sample is too small for the chance that was asked for: the interval is its whole range.
  bool is_range = false;
};

/// The interval between two order statistics, the k-th from below and the k-th from above, with the greatest
/// k whose coverage, 1 - 2 P(Binomial(n, 1/2) < k), is at least `coverage` (a share in (0, 1)). Six values
/// are the fewest that give 95 %. Zeros for no values.
MedianInterval median_interval(std::span<const double> values, double coverage = 0.95);

}  // namespace osteomill
