#pragma once

#include <string>

#include "osteomill/experiment/milling_trial.h"
#include "osteomill/recording/run_description.h"

namespace osteomill {

/// What every algorithm of a comparison has in common.
struct TrialPlan {
  /// As scanned; outlives the plan.
  const Volume& bone;
  std::string scan_name;
  BoneDensities densities;
  MillingEntry entry;
  TrialSettings settings;
  /// How the comparison was called, for whoever wants to repeat it.
  std::string command_line;
  /// Recordings carry the mode in their names, as a comparison of both modes needs.
  bool mode_in_names = false;
};

/// All that a recording says of a phase of section 8.2: what any session's says, and hand, device and script.
RunDescription describe_trial(const TrialPlan& plan, AlgorithmId algorithm, int sample_points,
                              RunPhase phase);

}  // namespace osteomill
