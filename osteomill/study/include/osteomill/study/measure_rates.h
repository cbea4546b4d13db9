#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/trial_plan.h"

namespace osteomill {

/// One line of section 8.1: how fast an algorithm steps at one resolution.
struct RateRow {
  AlgorithmId algorithm;
  /// The resolution in words: "50 vertices", "20 slices", "scale 2 and scale 3".
  std::string resolution;
  /// The number of sample points: vertices of the tool, or points of the shell.
  int points = 0;
  double step_us_median = 0;
  double step_us_p99 = 0;
  /// The SustainedRate of the ticks in a loop at 1000 Hz, as in the paper.
  double rate_hz = 0;
  /// The rate that the median step would allow with nothing else to do and nothing to wait for.
  double steps_per_s = 0;
  /// The paper's rate for this resolution, capped by its 1000 Hz loop; 0 if it has none.
  double paper_rate_hz = 0;
  /// Ticks done a second of the wall clock in a loop that was really held to 1000 Hz: the paper's measure.
  double paced_rate_hz = 0;
};

/// Returns the numbers of a line, the columns of rates.csv in their order; not a number for what the paper
/// does not have.
template <>
const std::vector<Field<RateRow>>& fields_of<RateRow>();

/// Measures section 8.1: step time against resolution, for the resolutions of the paper (50 to 1000 vertices,
/// 10 to 100 slices, shells at scale 1, 2 and 3), and for barrier-shell, which is not the paper's, for points
/// 0.26, 0.13 and 0.10 mm apart. For each, the simulated hand presses and leans on the bone without removing
/// any (the plan with another algorithm, spindle and resolution), and the steps in contact are timed; all of
/// them if none touches. Then the hand does the same in real time, held to the tick by the wall clock: from
/// the first contact on for 2 s, or to its end. A resolution with as many points as one before is named in
/// that one's row. `progress` is told what comes next and how much is done.
std::vector<RateRow> measure_rates(const TrialPlan& plan, const std::vector<AlgorithmDescription>& algorithms,
                                   const std::function<void(std::string_view, double)>& progress);

}  // namespace osteomill
