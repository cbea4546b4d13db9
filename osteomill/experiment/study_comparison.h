#pragma once

#include <vector>

#include "osteomill/experiment/statistics.h"
#include "osteomill/experiment/study.h"

namespace osteomill {

/// Two algorithms in one mode and phase, paired seed by seed.
struct AlgorithmPair {
  AlgorithmId first;
  AlgorithmId second;
  /// Of the two by the sums of signed ranks; `first` where neither.
  AlgorithmId greater;
  /// Wilcoxon's signed-rank test, exact, two-sided, after Holm's correction over the pairs of algorithms.
  double p = 1;
};

/// Every pair of the algorithms that were tried.
std::vector<AlgorithmPair> compare_algorithms(const Study& study, Mode mode, std::string_view phase,
                                              const RunFigure& figure);

/// What `steady` makes of one algorithm's figure, paired with `paper` seed by seed.
struct ModeChange {
  AlgorithmId algorithm;
  /// In which it could be measured in both modes; all that follows is of these.
  std::size_t hands = 0;
  MedianInterval paper;
  MedianInterval steady;
  /// Of steady / paper, over the seeds whose value in `paper` is not zero; `ratios` counts them.
  MedianInterval ratio;
  std::size_t ratios = 0;
  /// `steady` has less, by the sums of signed ranks.
  bool falls = false;
  /// As above, after Holm's correction over the algorithms.
  double p = 1;
};

/// For each algorithm that was tried in both modes; empty where there are not both.
std::vector<ModeChange> compare_modes(const Study& study, std::string_view phase, const RunFigure& figure);

}  // namespace osteomill
