#pragma once

#include "app/record_trial.h"

namespace osteomill::app {

/// What a recording of any run says of it.
struct RunFacts {
  std::string scan_name;
  GridGeometry geometry;
  double isovalue = 0;
  BoneDensities densities;
  MillingTool tool;
  HapticSettings haptics;
  MillingSettings milling;
  WrenchLimits limits;
  HandSettings hand;
  HandleSettings device;
  std::uint64_t seed = 0;
  double tick_s = 1e-3;
  std::string command_line;
};
RunDescription describe_run(const RunFacts& facts, AlgorithmId algorithm, int sample_points);

/// All that a recording says of a run of section 8.2: program, scan, tool, every setting with its unit.
RunDescription describe_run(const TrialPlan& plan, AlgorithmId algorithm, int sample_points, RunPhase phase);

}  // namespace osteomill::app
