#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/study/trial_plan.h"

namespace osteomill {

/// A row of section 8.1: the speed of an algorithm at one resolution.
struct RateRow {
  AlgorithmId algorithm;
  /// Resolution as text: "50 vertices", "20 slices", "scale 2 and scale 3".
  std::string resolution;
  /// Number of sample points: vertices of the tool, or points of the shell.
  int points = 0;
  double step_us_median = 0;
  double step_us_p99 = 0;
  /// SustainedRate of the ticks in a 1000 Hz loop, as in the paper.
  double rate_hz = 0;
  /// Rate that the median step time would allow with no other work and no waiting.
  double steps_per_s = 0;
  /// The paper's rate for this resolution, capped by its 1000 Hz loop; 0 if the paper has none.
  double paper_rate_hz = 0;
  /// Ticks per second of wall-clock time in a loop actually paced at 1000 Hz: the paper's measure.
  double paced_rate_hz = 0;
};

/// Returns the numeric columns of rates.csv, in order; NaN if the paper has no rate.
template <>
const std::vector<Field<RateRow>>& fields_of<RateRow>();

/// Measures section 8.1: step time against resolution, for the resolutions of the paper (50 to 1000 vertices,
/// 10 to 100 slices, shells at scale 1, 2 and 3), and for barrier-shell, which the paper does not have, for
/// point spacings of 0.26, 0.13 and 0.10 mm. For each, the simulated hand presses and leans on the bone
/// without removing any (`plan` with another algorithm, spindle and resolution), and the steps in contact are
/// timed, or all steps if there is no contact. Then the hand repeats this in real time, paced by the wall
/// clock, for 2 s from the first contact, or to its end. A resolution with as many points as an earlier one
/// is added to the earlier row. `progress` receives the name of the next algorithm and the fraction done.
std::vector<RateRow> measure_rates(const TrialPlan& plan, const std::vector<AlgorithmDescription>& algorithms,
                                   const std::function<void(std::string_view, double)>& progress);

}  // namespace osteomill
