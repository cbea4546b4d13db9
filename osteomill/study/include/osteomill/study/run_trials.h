#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "osteomill/study/entry_pictures.h"
#include "osteomill/study/parallel.h"
#include "osteomill/study/run_events.h"
#include "osteomill/study/study.h"
#include "osteomill/study/trial_plan.h"
#include "osteomill/study/trial_rows.h"

namespace osteomill {

/// Runs `try_one` of each trial, side by side on `threads` threads, each in simulated time, and returns the
/// results in the order of the trials. `what` names the work for RunEvents::progress. Every command that runs
/// many trials runs them by this function.
template <typename Trial, typename TryOne>
auto run_trials(const std::vector<Trial>& trials, const std::string& what, std::size_t threads,
                const RunEvents& events, const TryOne& try_one) {
  std::vector<std::invoke_result_t<TryOne, const Trial&>> results(trials.size());
  const auto task = [&](std::size_t n) { results[n] = try_one(trials[n]); };
  run_in_parallel(trials.size(), threads, task, [&](std::size_t done) {
    events.progress(what, static_cast<double>(done) / static_cast<double>(trials.size()));
  });
  return results;
}

/// The result of a trial of a study (try_trial()).
struct TriedTrial {
  /// One for each part of its test, without the trial's number.
  std::vector<TrialRow> rows;
  /// One sentence on ticks that were not as they should be; nothing if all were.
  std::optional<std::string> faults;
  double cpu_s = 0;
};
/// Runs one trial of a study on this thread. With the test `wall`, of the plan only the settings count, and
/// its bone is the wall.
TriedTrial try_trial(StudyTest test, const TrialPlan& plan);

/// Returns the plan's trial with another seed, in the hand that this seed draws (random_hand); what the
/// published ranges do not say of a hand (its push, its tremor) stays the plan's.
TrialPlan with_seed(const TrialPlan& plan, std::uint64_t seed);

/// Returns the plan's trial of algorithm 2 in its hand's other grips, for the paper's finding on them
/// (findings.h).
std::vector<TrialPlan> trials_in_other_grips(const TrialPlan& plan);

/// The plan's trial in the same hand with two other tremors each, by which one sees what tremor alone gives.
std::vector<TrialPlan> trials_with_other_tremors(const TrialPlan& plan);

/// Runs the trials, measures both phases, and keeps nothing else. Trials run side by side on `threads`
/// threads, each in simulated time; except for the step times, the rows are the same for any number of
/// threads. Warns if wrenches were clamped.
std::vector<MeasuredRun> run_study_trials(const std::vector<TrialPlan>& trials, std::size_t threads,
                                          const RunEvents& events);

/// Mills with `milled` and then holds in that same hole with each of `holds`, in the hand of `milled`.
/// Returns the run of each holding, without its first second (at most half of it), in which the
/// algorithms are exchanged. Throws
/// std::invalid_argument if a setting is out of range.
std::vector<MeasuredRun> hold_in_one_hole(const TrialPlan& milled, const std::vector<TrialPlan>& holds);

/// Returns a text that no other comparison has (kComparisonKey).
std::string new_comparison();

/// Returns whether a comparison writes a file or folder of this name: a recording that `record_trial` names,
/// or a part of the report.
bool is_of_a_comparison(const std::string& name);

/// Runs the trial through both phases of section 8.2 and then writes one recording a phase into `folder`,
/// with pictures of the bone before and after in the first, or a setting that says why there are none.
/// Returns their paths. Throws InputError if a recording cannot be written, and std::invalid_argument
/// if a setting is out of range.
std::vector<std::filesystem::path> record_trial(const TrialPlan& plan, const EntryPictures& pictures,
                                                const std::filesystem::path& folder, const RunEvents& events);

}  // namespace osteomill
