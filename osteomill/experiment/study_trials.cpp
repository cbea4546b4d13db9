#include "osteomill/experiment/study_trials.h"

#include <array>

#include <fmt/core.h>

#include "osteomill/experiment/findings.h"
#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/parallel.h"
#include "osteomill/experiment/phase_metrics.h"
#include "osteomill/report/run_groups.h"
#include "osteomill/session/tick_counts.h"

namespace osteomill {

namespace {

struct PhasesOfTrial {
  std::array<Recording, kPhases.size()> phases;
  FaultCount faults;
};

// What of a trial people should see.
struct Said {
  std::optional<std::string> faults;
  std::string shortfall;
};

PhasesOfTrial run(const StudyTrial& planned) {
  const auto& [plan, algorithm] = planned;
  MillingTrial trial(plan.bone, plan.densities, plan.entry, algorithm, plan.settings);
  PhasesOfTrial result;
  for (std::size_t n = 0; n < kPhases.size(); ++n) {
    Recording& recording = result.phases[n];
    recording.description =
        describe_trial(plan, algorithm, trial.algorithm().sample_point_count(), kPhases[n]);
    recording.path = fmt::format("{}, seed {}", algorithm.id.name, recording.description.seed);
  }
  while (!trial.finished()) {
    const MillingTrial::Tick tick = trial.tick();
    result.phases[tick.milling_phase ? 0 : 1].records.push_back(tick.record);
    result.faults.add(tick.record);
  }
  for (Recording& recording : result.phases) {
    std::string said =
        shortfall_words(trial.shortfall(), plan.settings.hand_and_device.script, recording.description.phase);
    if (!said.empty())
      recording.description.settings.push_back({std::string(kNotReachedKey), std::move(said), ""});
  }
  return result;
}

}  // namespace

StudyRow row_of(const TrialPlan& plan, const Recording& recording) {
  StudyRow row{recording.description.seed, plan.settings.hand_and_device.hand,
               measured_run(recording, phase_metrics(recording)), plan.grip};
  row.run.recording = nullptr;
  return row;
}

std::vector<StudyTrial> trials_in_other_grips(const TrialPlan& plan) {
  std::vector<StudyTrial> trials;
  for (const double grip : kGrips) {
    if (grip == 1) continue;
    trials.push_back({plan, algorithm_named(kPapersAlgorithms[1])});
    HandSettings& hand = trials.back().plan.settings.hand_and_device.hand;
    hand = gripping(hand, grip);
    trials.back().plan.grip = grip;
  }
  return trials;
}

TrialPlan with_seed(const TrialPlan& plan, std::uint64_t seed) {
  TrialPlan other = plan;
  OperatorSettings& person = other.settings.hand_and_device;
  const HandSettings asked_for = person.hand;
  person.seed = seed;
  person.hand = random_hand(seed);
  person.hand.push_N = asked_for.push_N;
  person.hand.push_lever_mm = asked_for.push_lever_mm;
  person.hand.tremor_mm = asked_for.tremor_mm;
  person.hand.tremor_rad = asked_for.tremor_rad;
  return other;
}

std::vector<StudyRow> run_study_trials(const std::vector<StudyTrial>& trials, std::size_t threads,
                                       const RunEvents& events) {
  std::vector<std::vector<StudyRow>> rows(trials.size());
  std::vector<Said> said(trials.size());
  const auto task = [&](std::size_t n) {
    const PhasesOfTrial trial = run(trials[n]);
    for (const Recording& recording : trial.phases) rows[n].push_back(row_of(trials[n].plan, recording));
    said[n] = {trial.faults.sentence(), rows[n].back().run.not_reached};
  };
  run_in_parallel(trials.size(), threads, task, [&](std::size_t done) {
    events.tell_progress("study", static_cast<double>(done) / static_cast<double>(trials.size()));
  });
  std::vector<StudyRow> all;
  for (std::size_t n = 0; n < trials.size(); ++n) {
    all.insert(all.end(), rows[n].begin(), rows[n].end());
    const TrialSettings& settings = trials[n].plan.settings;
    const auto warn = [&](const std::string& line) {
      events.warn(fmt::format("{}, {}, seed {}: {}", trials[n].algorithm.id.name,
                              name_of(settings.haptics.mode), settings.hand_and_device.seed, line));
    };
    if (said[n].faults) warn(*said[n].faults);
    if (!said[n].shortfall.empty()) warn(said[n].shortfall);
  }
  return all;
}

}  // namespace osteomill
