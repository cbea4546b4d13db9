#pragma once

#include <cstdint>

#include "osteomill/haptics/haptic_algorithm.h"

namespace osteomill::barrier_shell {

/// What the algorithm counts about itself, from its start.
struct Counts {
  std::uint64_t ticks = 0;
  /// Sums over the points.
  std::uint64_t passes = 0;
  /// The most points that a sum went through.
  std::uint64_t most_points = 0;
  /// Ticks that ended before the solver was done, at the best certified pose.
  std::uint64_t unfinished = 0;
  /// Ticks at whose start the stored energy was above that at the end of the tick before, with the device
  /// where it was: what milling or points brought up to date have added. By how much, in all and at worst.
  std::uint64_t energy_rises = 0;
  double energy_risen_Nmm = 0;
  double worst_rise_Nmm = 0;
  /// The nearest that a point came to a core, as a share of the skin's width.
  double nearest_share = 1;
};

/// Null where the algorithm is another one. Lives as long as the algorithm and changes with every tick.
const Counts* counts_of(const HapticAlgorithm& algorithm);

}  // namespace osteomill::barrier_shell
