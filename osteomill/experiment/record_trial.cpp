#include "osteomill/experiment/record_trial.h"

#include <algorithm>
#include <memory>
#include <utility>

#include <fmt/core.h>

#include "osteomill/experiment/entry_pictures.h"
#include "osteomill/experiment/paper.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
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
    recorders.push_back(
        std::make_unique<Recorder>(paths.back(), run, Recorder::kUsualCapacity,
                                   first ? Recorder::Begins::with_the_recording : Recorder::Begins::when_told,
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
    if (const Label* touched = labels.add(tick.record)) {
      events.tell_no_go(fmt::format("{}: {}", algorithm.id.name, no_go_warning(*touched, tick.record)));
    }
    if (n % kTicksBetweenProgress == 0) {
      // A trial that takes longer than asked for, since the hand does not yet feel what it should, stays at
      // its end.
      const double asked_s = script.milling_s + script.holding_s;
      events.tell_progress(algorithm.id.name, std::min(1.0, tick.record.time_s / asked_s));
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

}  // namespace osteomill
