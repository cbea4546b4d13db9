#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/metrics.h"

namespace osteomill {

/// Returns a run with these figures and with what its recording describes; the result points to the
/// recording.
MeasuredRun measured_run(const Recording& recording, const RunMetrics& metrics);
/// Returns the run with the figures of all its ticks. Throws as run_metrics.
MeasuredRun measured_run(const Recording& recording);

/// The runs of a report, by phase, then by algorithm.
struct RunGroup {
  std::vector<MeasuredRun> runs;

  /// Returns the run of an algorithm in a phase; null if there is none.
  const MeasuredRun* find(std::string_view algorithm, std::string_view phase) const;

  /// Returns the runs of a phase.
  std::vector<const MeasuredRun*> runs_of(std::string_view phase) const;
  /// Returns the phases that have a run, in the order of their first runs.
  std::vector<std::string> phases() const;
  /// Returns the algorithms that have a run, in the order of their labels.
  std::vector<AlgorithmId> algorithms() const;
};

/// Measures recordings; the runs point into `recordings`. Throws InputError if there are none, if two have
/// the same algorithm and phase, or if one cannot be measured (run_metrics).
RunGroup group_runs(const std::vector<Recording>& recordings,
                    MeasuredRun (*measure)(const Recording&) = measured_run);

}  // namespace osteomill
