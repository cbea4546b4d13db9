#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "osteomill/study/study.h"

#include "trials/statistics.h"

namespace osteomill {

/// A comparison of two algorithms by one figure, paired hand by hand.
struct PairedComparison {
  AlgorithmId first;
  AlgorithmId second;
  /// By the sums of signed ranks; false if they are equal.
  bool second_is_greater = false;
  /// Number of hands in which both could be measured.
  std::size_t hands = 0;
  /// Magnitude of the median difference, and its ratio to the smaller of the two medians (infinite if that is
  /// 0).
  double difference = 0;
  double share = 0;
  /// Whether a hand notices the difference (least_noticeable).
  bool is_noticeable = true;
  /// Whether another tremor in the same hand makes a larger difference.
  bool is_less_than_tremor = false;
  /// Exact two-sided p of Wilcoxon's signed-rank test, after Holm's correction over all comparisons made
  /// together.
  double p = 1;
  bool is_settled() const { return p <= kSignificance; }
};

/// Compares every pair of the study's algorithms over the hands in which both could be measured.
std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const Field<RunMetrics>& figure);

/// Returns whether there are at least two algorithms and enough hands to show a difference between them.
bool are_compared(const Study& study);

/// Returns the number of runs of one hand that differ only in tremor; 0 if no other tremors were tried.
std::size_t tremor_run_count(const Study& study);

/// Returns the median absolute difference of the figure between pairs of runs of one hand that differ only in
/// tremor; NaN if no other tremors were tried, or if the figure depends on the machine.
double tremor_effect(const Study& study, const AlgorithmId& algorithm, std::string_view phase,
                     const Field<RunMetrics>& figure);

}  // namespace osteomill
