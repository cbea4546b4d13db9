#pragma once

#include <string>

#include "osteomill/haptics/algorithm_id.h"

namespace osteomill {

/// How fast one algorithm steps at one resolution: a row of the test of section 8.1.
struct RateRow {
  AlgorithmId algorithm = AlgorithmId::line_proxy;
  /// As people read it: "50 vertices", "20 slices", "scale 2".
  std::string resolution;
  /// Sample points at that resolution (vertices, or points of the shell).
  int points = 0;
  double step_us_median = 0;
  double step_us_p99 = 0;
  /// What the step alone allows: 1e6 / step_us_median, not capped at the haptic rate.
  double rate_hz = 0;
  /// What the paper reports at this resolution; 0 where it reports nothing.
  double paper_rate_hz = 0;
};

}  // namespace osteomill
