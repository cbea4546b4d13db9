#pragma once

#include <vector>

#include "osteomill/study/study.h"

#include "trials/statistics.h"

namespace osteomill {

/// A figure of two that were tried, paired hand by hand.
struct PairedComparison {
  AlgorithmId first;
  AlgorithmId second;
  /// In how many hands it could be measured of both; all that follows is of these.
  std::size_t hands = 0;
  MedianInterval first_values;
  MedianInterval second_values;
  /// Of second / first, over the hands whose first value is not zero; `ratios` counts them.
  MedianInterval ratio;
  std::size_t ratios = 0;
  /// By the sums of signed ranks; false where neither is.
  bool second_is_greater = false;
  /// Wilcoxon's signed-rank test, exact, two-sided, after Holm's correction over all that is compared with
  /// it.
  double p = 1;
};

/// Compares every pair of the algorithms that were tried.
std::vector<PairedComparison> compare_algorithms(const Study& study, std::string_view phase,
                                                 const RunFigure& figure);

}  // namespace osteomill
