#pragma once

#include <functional>

#include "osteomill/experiment/wall_press.h"

namespace osteomill {

/// The greatest stiffness at which a wall stays passive.
struct StiffnessLimit {
  enum class Kind : unsigned char {
    /// To within 3 %.
    found,
    /// Every stiffness tried was passive, up to 200 N/mm.
    above_all,
    /// None was, from 0.05 N/mm or from the softest that carries the force.
    below_all,
  };
  Kind kind = Kind::below_all;
  /// The greatest passive one that was tried; 0 for `below_all`.
  double stiffness_N_per_mm = 0;
  /// What was felt of it.
  double felt_N_per_mm = 0;
};

/// Seeks the limit from `start_N_per_mm` by doubling or halving until it is enclosed, then by bisection of
/// the logarithm. Where the wall is passive, not passive and passive again as it gets stiffer, it finds one
/// of the limits.
StiffnessLimit seek_stiffness_limit(const std::function<WallPressResult(double stiffness_N_per_mm)>& press,
                                    double start_N_per_mm);

/// The greatest stiffness of an ideal wall, sampled every `tick_s` and felt `delay_s` later, that a device of
/// this damping keeps passive where it swings slowly against the tick: 2 b / (T + 2 tau), after Colgate and
/// Schenkel (1997) and Diolaiti et al. (2006).
double passive_stiffness_rule_N_per_mm(double damping_Ns_per_mm, double tick_s, double delay_s);

}  // namespace osteomill
