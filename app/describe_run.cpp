#include "app/describe_run.h"

#include <fmt/core.h>

namespace osteomill::app {

namespace {

using Settings = std::vector<RunSetting>;

std::string point_text(const Vec3& v) {
  return fmt::format("{},{},{}", v.x(), v.y(), v.z());
}

void add_algorithm(Settings& settings, AlgorithmId algorithm, const HapticSettings& haptics,
                   int sample_points) {
  settings.push_back({"sample_points", static_cast<double>(sample_points), ""});
  for (const SettingValue& value : describe_algorithm(algorithm, haptics)) {
    settings.push_back({"algorithm." + value.name, value.value, value.unit});
  }
}

void add_milling(Settings& settings, const MillingSettings& milling, const BoneDensities& densities) {
  settings.push_back({"milling.removal_rate", milling.removal_rate_mm3_per_Ns, "mm^3/(N s)"});
  settings.push_back({"milling.reach", milling.reach_voxels, "voxels"});
  settings.push_back({"milling.surroundings_density", densities.surroundings, ""});
  settings.push_back({"milling.reference_density", densities.reference, ""});
}

void add_hand(Settings& settings, const HandSettings& hand) {
  settings.push_back({"hand.push", hand.push_N, "N"});
  settings.push_back({"hand.push_lever", hand.push_lever_mm, "mm"});
  settings.push_back({"hand.stiffness", hand.stiffness_N_per_mm, "N/mm"});
  settings.push_back({"hand.damping", hand.damping_Ns_per_mm, "N s/mm"});
  settings.push_back({"hand.torsional_stiffness", hand.torsional_stiffness_Nmm_per_rad, "N mm/rad"});
  settings.push_back({"hand.torsional_damping", hand.torsional_damping_Nmms_per_rad, "N mm s/rad"});
  settings.push_back({"hand.tremor", hand.tremor_mm, "mm"});
}

void add_device(Settings& settings, const HandleSettings& device, const WrenchLimits& limits) {
  settings.push_back({"device.mass", device.mass_kg, "kg"});
  settings.push_back({"device.inertia", device.inertia_kg_m2, "kg m^2"});
  settings.push_back({"device.position_step", device.position_step_mm, "mm"});
  settings.push_back({"device.rotation_step", device.rotation_step_rad, "rad"});
  settings.push_back({"device.force_delay", device.force_delay_s, "s"});
  settings.push_back({"device.substep", device.substep_s, "s"});
  settings.push_back({"limit.force", limits.force_N, "N"});
  settings.push_back({"limit.torque", limits.torque_Nmm, "N mm"});
}

void add_script(Settings& settings, const ScriptSettings& script, const MillingEntry& entry) {
  settings.push_back({"script.entry", point_text(entry.point_W), "mm"});
  settings.push_back({"script.direction", point_text(entry.direction_W), ""});
  settings.push_back({"script.milling", script.milling_s, "s"});
  settings.push_back({"script.holding", script.holding_s, "s"});
  settings.push_back({"script.depth", script.depth_mm, "mm"});
}

}  // namespace

RunDescription describe_run(const RunFacts& facts, AlgorithmId algorithm, int sample_points) {
  RunDescription run;
  run.program_version = OSTEOMILL_VERSION;
  run.scan_name = facts.scan_name;
  run.dims = facts.geometry.dims;
  run.spacing_mm = facts.geometry.spacing_mm;
  run.isovalue = facts.isovalue;
  run.tool = facts.tool;
  run.algorithm = algorithm;
  run.mode = facts.haptics.mode;
  run.seed = facts.seed;
  run.tick_period_s = facts.tick_s;
  run.settings.push_back({std::string(kCommandLineKey), facts.command_line, ""});
  add_algorithm(run.settings, algorithm, facts.haptics, sample_points);
  add_milling(run.settings, facts.milling, facts.densities);
  add_hand(run.settings, facts.hand);
  add_device(run.settings, facts.device, facts.limits);
  return run;
}

RunDescription describe_run(const TrialPlan& plan, AlgorithmId algorithm, int sample_points, RunPhase phase) {
  const TrialSettings& trial = plan.settings;
  const OperatorSettings& hand_and_device = trial.hand_and_device;
  const Volume& bone = plan.bone.volume;
  RunDescription run =
      describe_run({plan.bone.name, bone.geometry(), bone.isovalue(), plan.densities, trial.tool,
                    trial.haptics, trial.milling, trial.limits, hand_and_device.hand, hand_and_device.handle,
                    hand_and_device.seed, trial.tick_s, plan.command_line},
                   algorithm, sample_points);
  run.phase = phase;
  add_script(run.settings, hand_and_device.script, plan.entry);
  return run;
}

}  // namespace osteomill::app
