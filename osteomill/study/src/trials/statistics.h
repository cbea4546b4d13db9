#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace osteomill {

/// Significance level.
inline constexpr double kSignificance = 0.05;

/// Wilcoxon's signed-rank test of paired differences.
struct SignedRank {
  /// Number of nonzero differences; only these are ranked.
  std::size_t pairs = 0;
  /// Sums of the ranks of the positive and of the negative differences.
  double positive = 0;
  double negative = 0;
  /// Two-sided and exact: the fraction of all 2^pairs assignments of signs to the ranks whose smaller sum is
  /// at most the observed one. 1 if there are no differences.
  double p = 1;
};

/// Returns the test of these differences. Ties share the mean of their ranks, and the distribution is that of
/// the tied ranks. Takes time proportional to the cube of the number of differences (0.01 s for 200).
SignedRank signed_rank(std::span<const double> differences);

/// Returns p as text: "p = 0.012", "p < 0.001".
std::string p_text(double p);

/// Returns the smallest p that this test can give with n differences: 2^(1 - n).
double min_p(std::size_t differences);

/// Applies Holm's correction for multiple tests (1979). Returns adjusted p-values in the same order, each to
/// be compared with the significance level on its own.
std::vector<double> holm_corrected(std::span<const double> p);

/// Returns the probability of fewer than k heads in n coin tosses: P(Binomial(n, 1/2) < k).
double chance_of_fewer_heads(std::size_t k, std::size_t tosses);

/// Median of a sample, and a confidence interval of the median of its distribution.
struct MedianInterval {
  double median = 0;
  double low = 0;
  double high = 0;
  /// Exact probability that such an interval covers the median, for any distribution.
  double coverage = 0;
  /// True if the sample is too small for the requested coverage: the interval is then its whole range.
  bool is_range = false;
};

/// Returns the interval between two order statistics, the k-th smallest and the k-th largest, with the
/// largest k whose coverage, 1 - 2 P(Binomial(n, 1/2) < k), is at least `coverage` (in (0, 1)). 95 % needs at
/// least six values. Zeros if there are no values.
MedianInterval median_interval(std::span<const double> values, double coverage = 0.95);

}  // namespace osteomill
