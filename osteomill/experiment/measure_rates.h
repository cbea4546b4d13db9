#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "osteomill/experiment/milling_trial.h"
#include "osteomill/experiment/rate_row.h"

namespace osteomill {

/// Section 8.1: step time against resolution, for the resolutions of the paper (50 to 1000 vertices, 10 to
/// 100 slices, shells at scale 1, 2 and 3), and for barrier-shell, which is not the paper's, for points 0.26,
/// 0.13 and 0.10 mm apart. For each, the simulated hand presses and leans on the bone without removing any
/// (`settings` but for the spindle and the resolution), and the steps in contact are timed; all of them where
/// none touches. Then the hand does the same in real time, held to the tick by the wall clock: from the first
/// contact on for 2 s, or to its end. `progress` hears what comes next and how much is done.
std::vector<RateRow> measure_rates(const Volume& bone, const BoneDensities& densities,
                                   const MillingEntry& entry,
                                   const std::vector<AlgorithmDescription>& algorithms,
                                   const TrialSettings& settings,
                                   const std::function<void(std::string_view, double)>& progress);

}  // namespace osteomill
