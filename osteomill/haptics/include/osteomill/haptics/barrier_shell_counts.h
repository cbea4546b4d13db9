#pragma once

#include <cstdint>

#include "osteomill/haptics/haptic_algorithm.h"

namespace osteomill::barrier_shell {

/// Statistics of barrier-shell since its start (counts_of()).
struct Counts {
  std::uint64_t ticks = 0;
  /// Number of energy evaluations over the points.
  std::uint64_t passes = 0;
  /// Largest number of points in one evaluation.
  std::uint64_t max_points = 0;
  /// Ticks that ended at the best certified pose before the solver converged.
  std::uint64_t unfinished = 0;
  /// Ticks that started with more stored energy than the previous tick's end, for the same device pose:
  /// milling or updated points have added energy.
  std::uint64_t energy_rises = 0;
  /// Sum and maximum of these rises.
  double energy_risen_Nmm = 0;
  double worst_rise_Nmm = 0;
  /// Smallest distance between a point and a core, as a share of the skin's width.
  double min_distance_share = 1;
};

/// Returns the counts of barrier-shell; null for another algorithm. Valid as long as the algorithm exists;
/// changes with every tick.
const Counts* counts_of(const HapticAlgorithm& algorithm);

}  // namespace osteomill::barrier_shell
