#include "osteomill/report/run_groups.h"

#include <algorithm>

#include <fmt/format.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

const MeasuredRun* RunGroup::find(AlgorithmId algorithm, RunPhase phase) const {
  for (const MeasuredRun& run : runs) {
    const RunDescription& description = run.recording->description;
    if (description.algorithm == algorithm && description.phase == phase) return &run;
  }
  return nullptr;
}

std::vector<RunPhase> RunGroup::phases() const {
  std::vector<RunPhase> present;
  for (const RunPhase phase : kAllPhases) {
    const auto of_phase = [&](const MeasuredRun& run) { return run.recording->description.phase == phase; };
    if (std::any_of(runs.begin(), runs.end(), of_phase)) present.push_back(phase);
  }
  return present;
}

std::vector<AlgorithmId> RunGroup::algorithms() const {
  std::vector<AlgorithmId> present;
  for (const AlgorithmId algorithm : kAllAlgorithms) {
    const auto of_algorithm = [&](const MeasuredRun& run) {
      return run.recording->description.algorithm == algorithm;
    };
    if (std::any_of(runs.begin(), runs.end(), of_algorithm)) present.push_back(algorithm);
  }
  return present;
}

std::vector<RunGroup> group_runs(const std::vector<Recording>& recordings) {
  if (recordings.empty()) throw InputError("report", "there are no recordings to report on");
  std::vector<RunGroup> groups;
  for (const Mode mode : {Mode::paper, Mode::steady}) {
    RunGroup group{mode, {}};
    for (const Recording& recording : recordings) {
      const RunDescription& d = recording.description;
      if (d.mode != mode) continue;
      if (const MeasuredRun* twin = group.find(d.algorithm, d.phase)) {
        throw InputError(
            recording.path.string(),
            fmt::format("is {}, {}, {} as {} is; a report has room for one of them", name_of(d.algorithm),
                        name_of(d.mode), name_of(d.phase), twin->recording->path.string()));
      }
      group.runs.push_back({&recording, run_metrics(recording)});
    }
    const auto order = [](const MeasuredRun& run) {
      return std::pair(run.recording->description.phase, run.recording->description.algorithm);
    };
    std::sort(group.runs.begin(), group.runs.end(),
              [&](const MeasuredRun& a, const MeasuredRun& b) { return order(a) < order(b); });
    if (!group.runs.empty()) groups.push_back(std::move(group));
  }
  return groups;
}

std::string_view numbered_name(AlgorithmId algorithm) {
  switch (algorithm) {
    case AlgorithmId::line_proxy:
      return "1 line-proxy";
    case AlgorithmId::surface_points:
      return "2 surface-points";
    case AlgorithmId::point_shell:
      return "3 point-shell";
  }
  return "";
}

double paper_mean_rate_hz(AlgorithmId algorithm, RunPhase phase) {
  const bool milling = phase == RunPhase::milling;
  switch (algorithm) {
    case AlgorithmId::line_proxy:
      return milling ? 976 : 988;
    case AlgorithmId::surface_points:
      return milling ? 955 : 963;
    case AlgorithmId::point_shell:
      return milling ? 973 : 989;
  }
  return 0;
}

}  // namespace osteomill
