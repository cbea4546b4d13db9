#pragma once

#include "osteomill/milling/cut_voxels.h"

namespace osteomill {

/// How far ahead of its centre a ball cuts, and which part of each drop is made.
struct BurrAdvance {
  double ahead_mm = 0;
  CutVoxels::Shares shares;
};

/// The ball's place between `min_ahead_mm` and `max_ahead_mm` where cutting to its surface takes just the
/// `budget` (a sum of densities, above 0); searched from `start_ahead_mm`. Bone that the trailing half
/// overlaps is paid first, with at most half the budget. Where even the least place takes more, part of each
/// drop is made; never is more spent than the budget, but for how floats round. Safe in the haptic tick.
BurrAdvance advance_within(double budget, const CutVoxels& voxels, double start_ahead_mm, double min_ahead_mm,
                           double max_ahead_mm);

}  // namespace osteomill
