#include "osteomill/study/trial_plan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "osteomill/recording/run_description.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/run_groups.h"

namespace osteomill {

namespace {

std::string point_text(const Vec3& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

}  // namespace

RunDescription describe_trial(const TrialPlan& plan, int sample_points, std::string_view phase) {
  const TrialSettings& trial = plan.settings;
  const OperatorSettings& person = trial.hand_and_device;
  RunDescription run =
      describe_run(plan.bone, plan.scan, {trial, plan.densities}, sample_points, plan.command_line);
  run.seed = person.seed;
  run.phase = phase;
  run.settings.insert(run.settings.end(), plan.scan_settings.begin(), plan.scan_settings.end());
  run.settings.push_back({std::string(kScriptEntryKey), point_text(plan.entry.point_W), "mm"});
  run.settings.push_back({std::string(kScriptDirectionKey), point_text(plan.entry.direction_W), ""});
  run.settings.push_back({"script.lateral", point_text(plan.entry.lateral_W), ""});
  run.settings.push_back({"script.depth", ScriptSettings::depth_mm, "mm"});
  put_fields(run, person);
  if (!plan.comparison.empty()) run.settings.push_back({std::string(kComparisonKey), plan.comparison, ""});
  if (plan.matched_N_per_mm) {
    run.settings.push_back({std::string(kMatchedStiffnessKey), *plan.matched_N_per_mm, "N/mm"});
  }
  if (!plan.not_matched.empty()) run.settings.push_back({std::string(kNotMatchedKey), plan.not_matched, ""});
  if (plan.probed) {
    run.settings.push_back({kFeltStiffnessKey, plan.probed->felt_N_per_mm, "N/mm"});
    if (!std::isnan(plan.probed->torque_error))
      run.settings.push_back({kTorqueErrorKey, plan.probed->torque_error, ""});
  }
  return run;
}

std::string shortfall_words(const ScriptShortfall& shortfall, const ScriptSettings& script,
                            std::string_view phase) {
  std::vector<std::string> parts;
  if (shortfall.shallow)
    parts.push_back(fmt::format("the hole was shallower than {:g} mm when feeding ended", script.depth_mm));
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
  // The spindle is off while holding: if there is no contact at all, it was lost before.
  metrics.contact.lost_while_milling |= recording.description.phase == kHolding && metrics.contact.any == 0;
  if (metrics.contact.is_lost()) {
    metrics.force_N = metrics.torque_Nmm = kNotFelt;
    metrics.shaft = {kNotMeasured, kNotMeasured};
    metrics.shaft_from_handle_deg = kNotMeasured;
    metrics.turns = {kNotMeasured, kNotMeasured};
    metrics.torque_follows_force = metrics.contacts_mean = kNotMeasured;
  }
  return metrics;
}

std::string broken_hold_words(const RunMetrics& metrics, std::string_view phase) {
  std::vector<std::string> parts;
  if (phase != kHolding) return "";
  if (metrics.contact.any < kHeldContact)
    parts.push_back(fmt::format("the tool touched for less than {:g} % of the holding", 100 * kHeldContact));
  if (metrics.contact.shaft < kHeldShaft) {
    parts.push_back(
        fmt::format("the shaft was against the wall for less than {:g} % of the holding", 100 * kHeldShaft));
  }
  if (metrics.shaft.excursion_deg > kHeldTurn_deg)
    parts.push_back(fmt::format("the shaft turned by more than {:g} degrees", kHeldTurn_deg));
  if (metrics.burr_excursion_mm > kHeldBurr_mm)
    parts.push_back(fmt::format("the burr moved by more than {:g} mm", kHeldBurr_mm));
  return fmt::format("{}", fmt::join(parts, "; "));
}

MeasuredRun measured_phase(const Recording& recording) {
  const RunDescription& run = recording.description;
  MeasuredRun measured = measured_run(recording, phase_metrics(recording));
  const std::string broken = broken_hold_words(measured.metrics, run.phase);
  if (!measured.not_reached.empty() && !broken.empty()) measured.not_reached += "; ";
  measured.not_reached += broken;
  return measured;
}

}  // namespace osteomill
