#pragma once

#include <functional>
#include <vector>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/study/milling_trial.h"
#include "osteomill/study/wall_press.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Largest stiffness at which a wall stays passive (seek_stiffness_limit()).
struct StiffnessLimit {
  enum class Kind : unsigned char {
    /// Found to within 3 %.
    found,
    /// Every stiffness tried was passive, up to 200 N/mm.
    above_all,
    /// No stiffness was passive, from 0.05 N/mm or from the softest that carries the force.
    below_all,
  };
  Kind kind = Kind::below_all;
  /// Largest passive stiffness that was tried; 0 for `below_all`.
  double stiffness_N_per_mm = 0;
  /// Stiffness felt with that setting.
  double felt_N_per_mm = 0;
};

/// Finds the largest passive stiffness: starts at `start_N_per_mm`, doubles or halves until the limit is
/// bracketed, then bisects the logarithm. If passivity is lost and regained as the wall gets stiffer, finds
/// one of the limits.
StiffnessLimit seek_stiffness_limit(const std::function<WallPressResult(double stiffness_N_per_mm)>& press,
                                    double start_N_per_mm);

/// Returns the largest stiffness of an ideal wall, sampled every `tick_s` and felt `delay_s` later, for which
/// a device of this damping stays passive when it oscillates slowly compared with the tick: 2 b / (T + 2
/// tau), after Colgate and Schenkel (1997) and Diolaiti et al. (2006).
double passive_stiffness_rule_N_per_mm(double damping_Ns_per_mm, double tick_s, double delay_s);

/// Largest passive stiffness of an algorithm on a device of this damping and delay.
struct PassivityRow {
  AlgorithmId algorithm;
  double damping_Ns_per_mm = 0;
  double delay_s = 0;
  /// In terms of the algorithm's own setting (--stiffness), which need not equal the stiffness felt.
  StiffnessLimit limit;
  /// Largest passive stiffness of an ideal wall there (passive_stiffness_rule_N_per_mm).
  double rule_N_per_mm = 0;
};

/// Returns the cases of the passivity test: every algorithm with a "stiffness" option, on devices with 1, 2,
/// 5 and 10 N s/m of damping and 0.3, 1 and 2 ms of delay; everything else as in `settings`.
std::vector<TrialSettings> passivity_cases(const std::vector<AlgorithmDescription>& algorithms,
                                           const TrialSettings& settings = {});

/// Presses on the wall (flat_wall, wall_press.h) with the algorithm, tool, tick and device of `settings`.
/// Throws std::invalid_argument if one is out of range.
WallPressResult press_on_wall(const TrialSettings& settings, const Volume& wall);

/// Finds the largest `--stiffness` at which the wall stays passive, using `press_on_wall`. Throws as
/// press_on_wall.
PassivityRow measure_passivity(TrialSettings settings, const Volume& wall);

}  // namespace osteomill
