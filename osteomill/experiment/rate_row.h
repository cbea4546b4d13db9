#pragma once

#include <string>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// One line of section 8.1: how fast an algorithm steps at one resolution.
struct RateRow {
  AlgorithmId algorithm;
  /// As people say it: "50 vertices", "20 slices", "scale 2".
  std::string resolution;
  /// Sample points: vertices of the tool, or points of the shell.
  int points = 0;
  double step_us_median = 0;
  double step_us_p99 = 0;
  /// HeldRate of the ticks: of a loop at 1000 Hz, as in the paper.
  double rate_hz = 0;
  /// What the median step would allow with nothing else to do and nothing to wait for.
  double steps_per_s = 0;
  /// What the paper has for this resolution, capped by its 1000 Hz loop.
  double paper_rate_hz = 0;
  /// Ticks done a second of the wall clock in a loop that was really held to 1000 Hz: the paper's measure.
  double paced_rate_hz = 0;
};

}  // namespace osteomill
