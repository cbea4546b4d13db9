#pragma once

#include <cstdint>

#include "osteomill/haptics/haptic_algorithm.h"

namespace osteomill::barrier_shell {

/// Counts that barrier-shell keeps about itself, from its start (counts_of()).
struct Counts {
  std::uint64_t ticks = 0;
  /// How many sums over the points were made.
  std::uint64_t passes = 0;
  /// The most points that a sum went through.
  std::uint64_t max_points = 0;
  /// Ticks that ended before the solver was done, at the best certified pose.
  std::uint64_t unfinished = 0;
  /// Ticks at whose start, with the device's pose unchanged, the stored energy was above that at the end of
  /// the tick before: milling or updated points have added energy.
  std::uint64_t energy_rises = 0;
  /// The sum of these rises, and the worst one.
  double energy_risen_Nmm = 0;
  double worst_rise_Nmm = 0;
  /// The nearest that a point came to a core, as a share of the skin's width.
  double nearest_share = 1;
};

/// Returns the counts of barrier-shell; null for another algorithm. They live as long as the algorithm and
/// change with every tick.
const Counts* counts_of(const HapticAlgorithm& algorithm);

}  // namespace osteomill::barrier_shell
