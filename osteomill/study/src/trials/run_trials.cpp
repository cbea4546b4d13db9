#include "osteomill/study/run_trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/session/tick_counts.h"
#include "osteomill/study/entry_pictures.h"
#include "osteomill/study/findings.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/parallel.h"
#include "osteomill/study/run_groups.h"
#include "osteomill/study/trial_plan.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr int kTicksBetweenProgress = 500;

// A multiple of kTremorStride is added to a hand's seed for another tremor, so that it is not the seed of any
// other hand of the study.
constexpr int kOtherTremors = 2;
constexpr std::uint64_t kTremorStride = 0x9e3779b97f4a7c15;

std::string recording_name(const TrialPlan& plan, std::string_view phase) {
  return fmt::format("{}-{}.h5", plan.settings.algorithm.id.name, phase);
}

// A trial that was run to its end.
struct MilledTrial {
  // Kept in memory; their paths hold the trial's name.
  std::array<Recording, kPhases.size()> phases;
  std::optional<std::string> faults;
};

void note_shortfall(const MillingTrial& trial, const ScriptSettings& script, Recording& phase) {
  std::string missed = shortfall_words(trial.shortfall(), script, phase.description.phase);
  if (!missed.empty())
    phase.description.settings.push_back({std::string(kNotReachedKey), std::move(missed), ""});
}

MilledTrial mill(const TrialPlan& plan, MillingTrial& trial, const RunEvents& events) {
  const std::string& name = plan.settings.algorithm.id.name;
  const ScriptSettings& script = plan.settings.hand_and_device.script;
  MilledTrial milled;
  for (std::size_t n = 0; n < kPhases.size(); ++n) {
    milled.phases[n].path = fmt::format("{}, seed {}", name, plan.settings.hand_and_device.seed);
    milled.phases[n].description = describe_trial(plan, trial.algorithm().sample_point_count(), kPhases[n]);
  }
  FaultCount faults;
  LabelCount labels(plan.bone.labels());
  for (int n = 0; !trial.finished(); ++n) {
    const MillingTrial::Tick tick = trial.tick();
    milled.phases[tick.milling_phase ? 0 : 1].records.push_back(tick.record);
    faults.add(tick.record);
    if (const auto touched = labels.add(tick.record)) events.no_go(fmt::format("{}: {}", name, *touched));
    if (n % kTicksBetweenProgress == 0) {
      // A trial may exceed its planned time if the hand does not yet feel what it should; progress then stays
      // at 100 %.
      const double asked_s = script.milling_s + script.holding_s;
      events.progress(name, std::min(1.0, tick.record.time_s / asked_s));
    }
  }
  for (Recording& phase : milled.phases) note_shortfall(trial, script, phase);
  milled.faults = faults.sentence();
  return milled;
}

}  // namespace

std::string new_comparison() {
  std::random_device device;
  return fmt::format("{:08x}{:08x}", device(), device());
}

bool is_comparison_output(const std::string& name) {
  constexpr std::string_view kReport[] = {"report.html",   "summary.csv",  "study.csv",
                                          "stability.csv", "one-hole.csv", "figures"};
  if (std::ranges::find(kReport, name) != std::end(kReport)) return true;
  return std::ranges::any_of(kPhases, [&](std::string_view phase) {
    const std::size_t dash = name.rfind(fmt::format("-{}.", phase));
    return dash != std::string::npos && name.ends_with(".h5") &&
           std::ranges::any_of(algorithm_names(), [&](const std::string& algorithm) {
             return name.starts_with(algorithm) && algorithm.size() <= dash;
           });
  });
}

std::vector<fs::path> record_trial(const TrialPlan& plan, const EntryPictures& pictures,
                                   const fs::path& folder, const RunEvents& events) {
  MillingTrial trial(plan.bone, plan.densities, plan.entry, plan.settings);
  const MilledTrial milled = mill(plan, trial, events);
  std::vector<fs::path> paths;
  for (const Recording& phase : milled.phases) {
    const bool first = paths.empty();
    RunDescription run = phase.description;
    if (!pictures.is_available())
      run.settings.push_back({std::string(kPicturesKey), "none, as OpenGL could not be had", ""});
    paths.push_back(folder / recording_name(plan, run.phase));
    Recorder recorder(
        paths.back(), run,
        first ? Recorder::FirstSession::begins_at_once : Recorder::FirstSession::begins_when_announced,
        Recorder::UnfinishedFile::remove);
    if (const std::string kept = recorder.leftover_note(); !kept.empty()) events.warn(kept);
    // The session continues from phase to phase.
    if (!first) recorder.begin_session(0, {.continues_from = paths.front().filename().string()});
    for (const TickRecord& record : phase.records) recorder.push_waiting(record);
    if (first) {
      for (const std::string_view name : {kPictureBefore, kPictureAfter, kPictureAlong})
        if (auto png = pictures.of(name, trial.volume(), events))
          recorder.add_picture(std::string(name), *std::move(png));
    }
    recorder.close();
  }
  if (milled.faults) events.warn(fmt::format("{}: {}", plan.settings.algorithm.id.name, *milled.faults));
  return paths;
}

TrialResult run_single_trial(StudyTest test, const TrialPlan& plan) {
  const double before_s = thread_cpu_s();
  TrialResult tried;
  if (test == StudyTest::milling) {
    MillingTrial trial(plan.bone, plan.densities, plan.entry, plan.settings);
    const MilledTrial milled = mill(plan, trial, {});
    for (std::size_t part = 0; part < milled.phases.size(); ++part) {
      const Recording& phase = milled.phases[part];
      TrialRow& row = tried.rows.emplace_back(TrialRow{.part = part, .run = measured_phase(phase)});
      row.run.recording = nullptr;
      row.run.grip = plan.grip;
      row.run.other_tremor = plan.other_tremor;
      row.run.seed -= kTremorStride * static_cast<std::uint64_t>(plan.other_tremor);
    }
    tried.faults = milled.faults;
  } else {
    tried.rows = {{.wall = wall_figures(plan.settings, press_on_wall(plan.settings, plan.bone))}};
  }
  tried.cpu_s = thread_cpu_s() - before_s;
  return tried;
}

std::vector<MeasuredRun> hold_in_one_hole(const TrialPlan& milled, const std::vector<TrialPlan>& holds) {
  MillingTrial milling(milled.bone, milled.densities, milled.entry, milled.settings);
  while (milling.is_milling() && !milling.finished()) milling.tick();
  std::vector<MeasuredRun> runs;
  for (TrialPlan hold : holds) {
    hold.settings.hand_and_device = milled.settings.hand_and_device;
    MillingTrial trial(milling, hold.settings);
    Recording holding;
    holding.path = fmt::format("{}, seed {}, in one hole", hold.settings.algorithm.id.name,
                               milled.settings.hand_and_device.seed);
    holding.description = describe_trial(hold, trial.algorithm().sample_point_count(), kHolding);
    const ScriptSettings& script = milled.settings.hand_and_device.script;
    const double left_out_s = std::min(script.settle_s, script.holding_s / 2);
    double exchanged_s = kNotMeasured;
    while (!trial.finished()) {
      const TickRecord record = trial.tick().record;
      if (std::isnan(exchanged_s)) exchanged_s = record.time_s;
      // Excludes the transient when the algorithms are exchanged.
      if (record.time_s >= exchanged_s + left_out_s) holding.records.push_back(record);
    }
    note_shortfall(trial, script, holding);
    runs.push_back(measured_phase(holding));
    runs.back().recording = nullptr;
  }
  return runs;
}

std::vector<TrialPlan> trials_in_other_grips(const TrialPlan& plan) {
  std::vector<TrialPlan> trials;
  for (const double grip : kGrips) {
    if (grip == 1) continue;
    TrialPlan& other = trials.emplace_back(plan);
    other.settings.algorithm = algorithm_named(kPapersAlgorithms[1]);
    HandSettings& hand = other.settings.hand_and_device.hand;
    hand = with_firmer_grip(hand, grip);
    other.grip = grip;
  }
  return trials;
}

std::vector<TrialPlan> trials_with_other_tremors(const TrialPlan& plan) {
  std::vector<TrialPlan> trials;
  for (int n = 1; n <= kOtherTremors; ++n) {
    TrialPlan& other = trials.emplace_back(plan);
    other.settings.hand_and_device.seed += kTremorStride * static_cast<std::uint64_t>(n);
    other.other_tremor = n;
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

namespace {

// Warns once per algorithm, with its first trial that had faulty ticks.
void warn_of_faults(const std::vector<TrialResult>& tried, const RunEvents& events) {
  struct Faults {
    std::string first;
    std::size_t trials = 0;
  };
  std::map<AlgorithmId, Faults> faults;
  for (const TrialResult& trial : tried) {
    if (!trial.faults) continue;
    const MeasuredRun& run = trial.rows.back().run;
    Faults& of_algorithm = faults[run.algorithm];
    if (++of_algorithm.trials > 1) continue;
    of_algorithm.first =
        fmt::format("seed {}{}{}: {}", run.seed, run.grip == 1 ? "" : fmt::format(", grip {:g}", run.grip),
                    run.other_tremor == 0 ? "" : ", another tremor", *trial.faults);
  }
  for (const auto& [algorithm, one] : faults)
    events.warn(fmt::format(
        "{}, {}{}", algorithm.name, one.first,
        one.trials == 1 ? "" : fmt::format("; such ticks also in {} other trials", one.trials - 1)));
}

}  // namespace

std::vector<MeasuredRun> run_study_trials(const std::vector<TrialPlan>& trials, std::size_t threads,
                                          const RunEvents& events) {
  const auto tried = run_trials(trials, "study", threads, events, [](const TrialPlan& plan) {
    return run_single_trial(StudyTest::milling, plan);
  });
  std::vector<MeasuredRun> all;
  for (const TrialResult& trial : tried)
    for (const TrialRow& row : trial.rows) all.push_back(row.run);
  warn_of_faults(tried, events);
  return all;
}

}  // namespace osteomill
