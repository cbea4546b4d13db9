#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/experiment/entry_pictures.h"
#include "osteomill/experiment/run_events.h"
#include "osteomill/experiment/trial_plan.h"

namespace osteomill {

/// Runs one algorithm through both phases of section 8.2 and writes one recording a phase into `folder`, with
/// pictures of the bone before and after in the first, or a setting that says why there are none. Returns
/// their paths. Throws InputError where a recording cannot be written, and std::invalid_argument where a
/// setting is out of range.
std::vector<std::filesystem::path> record_trial(const TrialPlan& plan, const AlgorithmDescription& algorithm,
                                                const EntryPictures& pictures,
                                                const std::filesystem::path& folder, const RunEvents& events);

}  // namespace osteomill
