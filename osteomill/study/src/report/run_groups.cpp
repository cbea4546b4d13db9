#include "osteomill/study/run_groups.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"

namespace osteomill {

MeasuredRun measured_run(const Recording& recording, const RunMetrics& metrics) {
  const RunDescription& d = recording.description;
  const std::string* not_reached = find_setting<std::string>(d, kNotReachedKey);
  constexpr double kMmPerM = 1000;
  const auto of_hand = [&](std::string_view key) {
    const double* value = find_setting<double>(d, key);
    return value == nullptr ? 0 : kMmPerM * *value;
  };
  return {.algorithm = d.algorithm,
          .phase = d.phase,
          .metrics = metrics,
          .recording = &recording,
          .not_reached = not_reached == nullptr ? "" : *not_reached,
          .seed = d.seed,
          .hand_stiffness_N_per_m = of_hand(kHandStiffnessKey),
          .hand_damping_Ns_per_m = of_hand(kHandDampingKey)};
}

MeasuredRun measured_run(const Recording& recording) {
  return measured_run(recording, run_metrics(recording));
}

const MeasuredRun* RunGroup::find(std::string_view algorithm, std::string_view phase) const {
  for (const MeasuredRun& run : runs) {
    if (run.algorithm == algorithm && run.phase == phase) return &run;
  }
  return nullptr;
}

std::vector<const MeasuredRun*> RunGroup::runs_of(std::string_view phase) const {
  std::vector<const MeasuredRun*> of_phase;
  for (const MeasuredRun& run : runs) {
    if (run.phase == phase) of_phase.push_back(&run);
  }
  return of_phase;
}

std::vector<std::string> RunGroup::phases() const {
  std::vector<std::string> present;
  for (const MeasuredRun& run : runs) {
    if (present.empty() || present.back() != run.phase) present.push_back(run.phase);
  }
  return present;
}

std::vector<AlgorithmId> RunGroup::algorithms() const {
  std::vector<AlgorithmId> present;
  for (const MeasuredRun& run : runs) present.push_back(run.algorithm);
  return sorted_unique(std::move(present));
}

namespace {

// Returns the start time of each phase's first recording, to order phases as they were run.
std::map<std::string, double> beginnings(const std::vector<Recording>& recordings) {
  std::map<std::string, double> began_s;
  for (const Recording& recording : recordings) {
    if (recording.records.empty()) continue;
    const double time_s = recording.records.front().time_s;
    const auto [place, is_new] = began_s.try_emplace(recording.description.phase, time_s);
    if (!is_new) place->second = std::min(place->second, time_s);
  }
  return began_s;
}

}  // namespace

RunGroup group_runs(const std::vector<Recording>& recordings, MeasuredRun (*measure)(const Recording&)) {
  if (recordings.empty()) throw InputError("report", "there are no recordings to report on");
  const std::map<std::string, double> began_s = beginnings(recordings);
  RunGroup group;
  for (const Recording& recording : recordings) {
    const RunDescription& d = recording.description;
    if (const MeasuredRun* twin = group.find(d.algorithm.name, d.phase)) {
      throw InputError(recording.path.string(),
                       fmt::format("is {}, {}, as is {}; a report takes only one of them",
                                   name_of(d.algorithm), d.phase, twin->recording->path.string()));
    }
    group.runs.push_back(measure(recording));
  }
  const auto order = [&](const MeasuredRun& run) {
    return std::tuple(began_s.at(run.phase), run.phase, run.algorithm);
  };
  std::sort(group.runs.begin(), group.runs.end(),
            [&](const MeasuredRun& a, const MeasuredRun& b) { return order(a) < order(b); });
  return group;
}

}  // namespace osteomill
