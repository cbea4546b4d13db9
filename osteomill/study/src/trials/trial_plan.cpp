#include "osteomill/study/trial_plan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/study/paper.h"

namespace osteomill {

namespace {

std::string point_text(const Vec3& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

// Three numbers as point_text writes them.
Vec3 point_of(const RunDescription& run, std::string_view key, const std::filesystem::path& path) {
  const std::string* text = find_setting<std::string>(run, key);
  const std::vector<std::string_view> parts =
      text == nullptr ? std::vector<std::string_view>() : csv_fields(*text);
  Vec3 point;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto number = n < parts.size() ? parsed_number<double>(parts[n]) : std::nullopt;
    if (!number || parts.size() != 3)
      throw InputError(path.string(), fmt::format("has no setting '{}' of three numbers", key));
    point[static_cast<Eigen::Index>(n)] = *number;
  }
  return point;
}

constexpr const char* kScriptDirectionKey = "script.direction";
constexpr const char* kScriptLateralKey = "script.lateral";

}  // namespace

RunDescription describe_trial(const TrialPlan& plan, int sample_points, std::string_view phase) {
  const TrialSettings& trial = plan.settings;
  const OperatorSettings& person = trial.hand_and_device;
  RunDescription run = describe_run(plan.bone, {trial, plan.densities}, sample_points, plan.command_line);
  run.scan_name = plan.scan_name;
  run.scan_hash = plan.scan_hash;
  run.seed = person.seed;
  run.phase = phase;
  run.settings.push_back({std::string(kScriptEntryKey), point_text(plan.entry.point_W), "mm"});
  run.settings.push_back({kScriptDirectionKey, point_text(plan.entry.direction_W), ""});
  run.settings.push_back({kScriptLateralKey, point_text(plan.entry.lateral_W), ""});
  run.settings.push_back({"script.depth", ScriptSettings::depth_mm, "mm"});
  put_fields(run, person);
  if (!plan.comparison.empty()) run.settings.push_back({std::string(kComparisonKey), plan.comparison, ""});
  if (plan.matched_N_per_mm) {
    run.settings.push_back({std::string(kMatchedStiffnessKey), *plan.matched_N_per_mm, "N/mm"});
  }
  return run;
}

RecordedTrial recorded_trial(const RunDescription& run, const std::filesystem::path& path) {
  const AlgorithmDescription* algorithm = find_algorithm(run.algorithm.name);
  if (algorithm == nullptr)
    throw InputError(path.string(), "its algorithm " + run.algorithm.name + " is not known here");
  SessionSettings session = session_settings(run, path);
  RecordedTrial trial;
  static_cast<MillingSetup&>(trial.settings) = std::move(session.setup);
  trial.densities = session.densities;
  trial.entry.point_W = point_of(run, kScriptEntryKey, path);
  trial.entry.direction_W = point_of(run, kScriptDirectionKey, path);
  trial.entry.lateral_W = point_of(run, kScriptLateralKey, path);
  trial.settings.algorithm = *algorithm;
  OperatorSettings& person = trial.settings.hand_and_device;
  person.handle.limits = trial.settings.guard.limits;
  take_fields(run, path, person);
  person.seed = run.seed;
  return trial;
}

std::string shortfall_words(const ScriptShortfall& shortfall, const ScriptSettings& script,
                            std::string_view phase) {
  std::vector<std::string> parts;
  if (shortfall.shallow)
    parts.push_back(fmt::format("the hole stayed shallower than {:g} mm", script.depth_mm));
  if (shortfall.hardly_leant) {
    parts.push_back(fmt::format("the shaft leant on the bone for less than {:g} s",
                                script.leant_share * script.milling_s));
  }
  if (shortfall.lost) parts.emplace_back("the tool was lost: it left the bone as the hand leant");
  if (shortfall.unsettled && phase == kHolding)
    parts.emplace_back("the hand did not come to feel what it wanted to hold");
  return fmt::format("{}", fmt::join(parts, "; "));
}

RunMetrics phase_metrics(const Recording& recording) {
  const std::size_t ticks = recording.records.size();
  std::size_t first = 0;
  const double* held_s = find_setting<double>(recording.description, kScriptHoldingKey);
  if (recording.description.phase == kHolding && held_s != nullptr && *held_s > 0) {
    const double held = std::round(*held_s / recording.description.tick_period_s);
    first = ticks - static_cast<std::size_t>(std::min(held, static_cast<double>(ticks)));
  }
  RunMetrics metrics = run_metrics(recording, first);
  // The spindle is off while holding: what does not touch at all was lost before.
  metrics.contact.lost_while_milling |= recording.description.phase == kHolding && metrics.contact.any == 0;
  if (metrics.contact.is_lost()) {
    metrics.force_N = metrics.torque_Nmm = kNotFelt;
    metrics.shaft = {kNotMeasured, kNotMeasured};
    metrics.turns = {kNotMeasured, kNotMeasured};
    metrics.torque_follows_force = metrics.contacts_mean = kNotMeasured;
  }
  return metrics;
}

}  // namespace osteomill
