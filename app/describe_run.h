#pragma once

#include "app/record_trial.h"

namespace osteomill::app {

/// All that a recording says of the run it holds: program, scan, tool, every setting with its unit.
RunDescription describe_run(const TrialPlan& plan, AlgorithmId algorithm, int sample_points, RunPhase phase);

}  // namespace osteomill::app
