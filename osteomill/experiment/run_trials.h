#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/experiment/entry_pictures.h"
#include "osteomill/experiment/run_events.h"
#include "osteomill/experiment/study.h"
#include "osteomill/experiment/trial_plan.h"

namespace osteomill {

/// One algorithm under one plan.
struct StudyTrial {
  TrialPlan plan;
  AlgorithmDescription algorithm;
};

/// The plan's trial with another seed, in the hand that this seed draws (random_hand); what the published
/// ranges do not say of a hand (its push, its tremor) stays the plan's.
TrialPlan with_seed(const TrialPlan& plan, std::uint64_t seed);

/// The plan's trial of algorithm 2 in its hand's other grips, for the paper's finding on them (findings.h).
std::vector<StudyTrial> trials_in_other_grips(const TrialPlan& plan);

/// The row of a phase that was recorded.
StudyRow row_of(const TrialPlan& plan, const Recording& recording);

/// Runs the trials, measures both phases, and keeps nothing else. Trials run side by side on `threads`
/// threads, each in simulated time: but for the step times, the rows are the same however many. Warns where
/// wrenches were clamped.
std::vector<StudyRow> run_study_trials(const std::vector<StudyTrial>& trials, std::size_t threads,
                                       const RunEvents& events);

/// Runs one algorithm through both phases of section 8.2 and writes one recording a phase into `folder`, with
/// pictures of the bone before and after in the first, or a setting that says why there are none. Returns
/// their paths. Throws InputError where a recording cannot be written, and std::invalid_argument where a
/// setting is out of range.
std::vector<std::filesystem::path> record_trial(const TrialPlan& plan, const AlgorithmDescription& algorithm,
                                                const EntryPictures& pictures,
                                                const std::filesystem::path& folder, const RunEvents& events);

}  // namespace osteomill
