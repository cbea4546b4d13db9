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

/// Calls `try_one` for each trial on `threads` threads, each in simulated time, and returns the results in
/// the order of the trials. `what` names the work for RunEvents::progress. Every command that runs many
/// trials uses this function.
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

/// Result of a trial of a study (run_single_trial()).
struct TrialResult {
  /// A row for each part of the test; the trial number is not set.
  std::vector<TrialRow> rows;
  /// A sentence on faulty ticks; nothing if there were none.
  std::optional<std::string> faults;
  double cpu_s = 0;
};
/// Runs one trial of a study on the calling thread. With the test `wall`, uses only `plan.settings`, and
/// `plan.bone` is the wall.
TrialResult run_single_trial(StudyTest test, const TrialPlan& plan);

/// Returns the plan's trial with another seed, in the hand that this seed draws (random_hand). What the
/// published ranges do not cover (push, tremor) is taken from the plan.
TrialPlan with_seed(const TrialPlan& plan, std::uint64_t seed);

/// Returns the plan's trial of algorithm 2 in the other grips of its hand, for the paper's finding on grips
/// (findings.h).
std::vector<TrialPlan> trials_in_other_grips(const TrialPlan& plan);

/// Returns the plan's trial in the same hand with two other tremors, which shows the effect of tremor alone.
std::vector<TrialPlan> trials_with_other_tremors(const TrialPlan& plan);

/// Runs the trials on `threads` threads, each in simulated time, and returns the figures of both phases;
/// keeps no recordings. Except for the step times, the rows do not depend on the number of threads. Warns if
/// wrenches were clamped.
std::vector<MeasuredRun> run_study_trials(const std::vector<TrialPlan>& trials, std::size_t threads,
                                          const RunEvents& events);

/// Mills with `milled`, then holds in that hole with each of `holds`, in the hand of `milled`. Returns one
/// run for each of `holds`, without its first second (at most half of it), in which the algorithms are
/// exchanged. Throws std::invalid_argument if a setting is out of range.
std::vector<MeasuredRun> hold_in_one_hole(const TrialPlan& milled, const std::vector<TrialPlan>& holds);

/// Returns a random identifier of a comparison (kComparisonKey).
std::string new_comparison();

/// Returns whether a comparison writes a file or folder of this name: a recording from `record_trial`, or a
/// part of the report.
bool is_comparison_output(const std::string& name);

/// Runs both phases of section 8.2 and then writes one recording per phase into `folder`. The first contains
/// pictures of the bone before and after, or a setting with the reason why there are none. Returns the paths
/// of the recordings. Throws InputError if a recording cannot be written, and std::invalid_argument if a
/// setting is out of range.
std::vector<std::filesystem::path> record_trial(const TrialPlan& plan, const EntryPictures& pictures,
                                                const std::filesystem::path& folder, const RunEvents& events);

}  // namespace osteomill
