#pragma once

#include <string_view>
#include <vector>

#include "osteomill/recording/recording.h"
#include "osteomill/report/metrics.h"

namespace osteomill {

/// A recording with its figures.
struct MeasuredRun {
  const Recording* recording;
  RunMetrics metrics;
};

/// The runs of one mode, which belong into the same figures; by phase, then in the paper's order of
/// algorithms.
struct RunGroup {
  Mode mode;
  std::vector<MeasuredRun> runs;

  /// Null where there is no such run.
  const MeasuredRun* find(AlgorithmId algorithm, RunPhase phase) const;
  /// Those that have a run.
  std::vector<RunPhase> phases() const;
  std::vector<AlgorithmId> algorithms() const;
};

/// Measures and groups recordings; the groups point into `recordings`. Throws InputError where there are
/// none, where two are of the same algorithm, mode and phase, or where one cannot be measured (run_metrics).
std::vector<RunGroup> group_runs(const std::vector<Recording>& recordings);

/// "1 line-proxy": the paper's number of the algorithm and its name.
std::string_view numbered_name(AlgorithmId algorithm);

/// The paper's mean haptic rate, figure 6.
double paper_mean_rate_hz(AlgorithmId algorithm, RunPhase phase);

}  // namespace osteomill
