#include "osteomill/experiment/run_trials.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "osteomill/experiment/entry_pictures.h"
#include "osteomill/experiment/findings.h"
#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/parallel.h"
#include "osteomill/experiment/trial_plan.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/report/run_groups.h"
#include "osteomill/session/tick_counts.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr int kTicksBetweenProgress = 500;

std::string recording_name(const TrialPlan& plan, const AlgorithmDescription& algorithm,
                           std::string_view phase) {
  const std::string mode =
      plan.mode_in_names ? fmt::format("-{}", name_of(plan.settings.haptics.mode)) : std::string();
  return fmt::format("{}{}-{}.h5", algorithm.id.name, mode, phase);
}

void add_pictures(Recorder& recorder, const EntryPictures& pictures, const Volume& milled,
                  const RunEvents& events) {
  if (pictures.before()) recorder.add_picture(std::string(kPictureBefore), *pictures.before());
  if (auto after = pictures.of(milled, events)) {
    recorder.add_picture(std::string(kPictureAfter), *std::move(after));
  }
  if (auto along = pictures.along(milled, events)) {
    recorder.add_picture(std::string(kPictureAlong), *std::move(along));
  }
}

}  // namespace

std::vector<fs::path> record_trial(const TrialPlan& plan, const AlgorithmDescription& algorithm,
                                   const EntryPictures& pictures, const fs::path& folder,
                                   const RunEvents& events) {
  MillingTrial trial(plan.bone, plan.densities, plan.entry, algorithm, plan.settings);
  std::vector<fs::path> paths;
  std::vector<std::unique_ptr<Recorder>> recorders;
  for (const std::string_view phase : kPhases) {
    paths.push_back(folder / recording_name(plan, algorithm, phase));
    RunDescription run = describe_trial(plan, algorithm, trial.algorithm().sample_point_count(), phase);
    if (!pictures.before()) {
      run.settings.push_back({std::string(kPicturesKey), "none, as OpenGL could not be had", ""});
    }
    const bool first = recorders.empty();
    recorders.push_back(std::make_unique<Recorder>(
        paths.back(), run, first ? Recorder::Begins::with_the_recording : Recorder::Begins::when_told,
        Recorder::Unfinished::removed));
    // The session goes on from phase to phase.
    if (!first) recorders.back()->begin_session(0, {.goes_on_from = paths.front().filename().string()});
  }
  Recorder& milling = *recorders[0];
  Recorder& holding = *recorders[1];
  const ScriptSettings& script = plan.settings.hand_and_device.script;
  FaultCount faults;
  LabelCount labels(plan.bone.labels());
  for (int n = 0; !trial.finished(); ++n) {
    const MillingTrial::Tick tick = trial.tick();
    (tick.milling_phase ? milling : holding).push_waiting(tick.record);
    faults.add(tick.record);
    if (const auto touched = labels.add(tick.record))
      events.no_go(fmt::format("{}: {}", algorithm.id.name, *touched));
    if (n % kTicksBetweenProgress == 0) {
      // A trial that takes longer than asked for, since the hand does not yet feel what it should, stays at
      // its end.
      const double asked_s = script.milling_s + script.holding_s;
      events.progress(algorithm.id.name, std::min(1.0, tick.record.time_s / asked_s));
    }
  }
  add_pictures(milling, pictures, trial.volume(), events);
  std::string not_reached;
  for (std::size_t n = 0; n < kPhases.size(); ++n) {
    not_reached = shortfall_words(trial.shortfall(), script, kPhases[n]);
    if (!not_reached.empty()) recorders[n]->add_setting({std::string(kNotReachedKey), not_reached, ""});
    recorders[n]->close();
  }
  if (!not_reached.empty())
    events.warn(
        fmt::format("{}, {}: {}", algorithm.id.name, name_of(plan.settings.haptics.mode), not_reached));
  if (const auto said = faults.sentence()) events.warn(fmt::format("{}: {}", algorithm.id.name, *said));
  return paths;
}

namespace {

struct MilledTrial {
  // One a phase.
  std::vector<StudyRow> rows;
  std::optional<std::string> faults;
};

MilledTrial mill(const StudyTrial& planned) {
  const TrialPlan& plan = planned.plan;
  const AlgorithmDescription& algorithm = planned.algorithm;
  MillingTrial trial(plan.bone, plan.densities, plan.entry, algorithm, plan.settings);
  std::array<Recording, kPhases.size()> phases;
  FaultCount faults;
  while (!trial.finished()) {
    const MillingTrial::Tick tick = trial.tick();
    phases[tick.milling_phase ? 0 : 1].records.push_back(tick.record);
    faults.add(tick.record);
  }
  MilledTrial tried{{}, faults.sentence()};
  for (std::size_t n = 0; n < kPhases.size(); ++n) {
    RunDescription& run = phases[n].description;
    run = describe_trial(plan, algorithm, trial.algorithm().sample_point_count(), kPhases[n]);
    phases[n].path = fmt::format("{}, seed {}", algorithm.id.name, run.seed);
    std::string missed = shortfall_words(trial.shortfall(), plan.settings.hand_and_device.script, kPhases[n]);
    if (!missed.empty()) run.settings.push_back({std::string(kNotReachedKey), std::move(missed), ""});
    tried.rows.push_back(row_of(plan, phases[n]));
  }
  return tried;
}

TrialRow press(const StudyTrial& trial) {
  const TrialSettings& settings = trial.plan.settings;
  const PassivityCase setup{trial.algorithm, settings.haptics.mode, trial.device_damping_Ns_per_mm,
                            settings.hand_and_device.handle.force_delay_s};
  return as_row(0, setup, press_on_wall(setup, trial.plan.bone, settings), settings.tick_s);
}

}  // namespace

TriedTrial try_trial(StudyTest test, const StudyTrial& trial) {
  const double before_s = thread_cpu_s();
  TriedTrial tried;
  if (test == StudyTest::milling) {
    const MilledTrial milled = mill(trial);
    for (std::size_t part = 0; part < milled.rows.size(); ++part)
      tried.rows.push_back(as_row(0, part, milled.rows[part]));
    tried.faults = milled.faults;
  } else {
    tried.rows.push_back(press(trial));
  }
  tried.cpu_s = thread_cpu_s() - before_s;
  return tried;
}

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
  const std::vector<MilledTrial> tried = run_trials(trials, "study", threads, events, mill);
  std::vector<StudyRow> all;
  for (std::size_t n = 0; n < trials.size(); ++n) {
    all.insert(all.end(), tried[n].rows.begin(), tried[n].rows.end());
    const TrialSettings& settings = trials[n].plan.settings;
    const auto warn = [&](const std::string& line) {
      events.warn(fmt::format("{}, {}, seed {}: {}", trials[n].algorithm.id.name,
                              name_of(settings.haptics.mode), settings.hand_and_device.seed, line));
    };
    if (tried[n].faults) warn(*tried[n].faults);
    if (const std::string& missed = all.back().run.not_reached; !missed.empty()) warn(missed);
  }
  return all;
}

}  // namespace osteomill
