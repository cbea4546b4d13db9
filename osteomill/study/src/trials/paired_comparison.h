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
  /// Decided by the sums of signed ranks; false if neither is.
  bool second_is_greater = false;
  /// Those in which both could be measured.
  std::size_t hands = 0;
  /// The size of the median difference, and that against the lesser of the two medians (infinite if that is
  /// 0).
  double difference = 0;
  double share = 0;
  /// Whether a hand notices it (least_noticeable).
  bool is_noticeable = true;
  /// Whether another tremor in the same hand gives as much.
  bool is_less_than_tremor = false;
  /// Wilcoxon's signed-rank test, exact, two-sided, after Holm's correction over all comparisons made
  /// together.
  double p = 1;
  bool is_settled() const { return p <= kSignificance; }
};

/// Compares every pair of the algorithms that were tried, by the hands in which both could be measured.
std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const Field<RunMetrics>& figure);

/// Returns whether there are two algorithms and hands enough to show a difference between them.
bool are_compared(const Study& study);

/// Returns how many runs of one hand differ in its tremor alone; 0 if no hand tried others.
std::size_t tremors_tried(const Study& study);

/// Returns by how much the figure differs between two runs of one hand that differ in its tremor alone: the
/// median over the pairs of runs; not a number if no hand tried other tremors, or the machine decides the
/// figure.
double given_by_tremor(const Study& study, const AlgorithmId& algorithm, std::string_view phase,
                       const Field<RunMetrics>& figure);

}  // namespace osteomill
