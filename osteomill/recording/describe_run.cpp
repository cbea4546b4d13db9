#include "osteomill/recording/describe_run.h"

#include "osteomill/haptics/algorithms.h"

namespace osteomill {

namespace {

using Settings = std::vector<RunSetting>;

void add_algorithm(Settings& settings, const AlgorithmDescription& algorithm, const HapticSettings& haptics,
                   int sample_points) {
  settings.push_back({"sample_points", static_cast<double>(sample_points), ""});
  for (const SettingValue& value : setting_values(algorithm, haptics)) {
    settings.push_back({"algorithm." + value.name, value.value, value.unit});
  }
}

void add_milling(Settings& settings, const MillingSettings& milling, const BoneDensities& densities) {
  settings.push_back({"milling.removal_rate", milling.removal_rate_mm3_per_Ns, "mm^3/(N s)"});
  settings.push_back({"milling.reaction_share", milling.reaction_share, ""});
  settings.push_back({"milling.surroundings_density", densities.surroundings, ""});
  settings.push_back({"milling.reference_density", densities.reference, ""});
}

void add_limits(Settings& settings, const WrenchLimits& limits) {
  settings.push_back({"limit.force", limits.force_N, "N"});
  settings.push_back({"limit.torque", limits.torque_Nmm, "N mm"});
}

}  // namespace

RunDescription describe_run(const RunFacts& facts, const AlgorithmDescription& algorithm, int sample_points) {
  RunDescription run;
  run.program_version = OSTEOMILL_VERSION;
  run.scan_name = facts.scan_name;
  run.dims = facts.geometry.dims;
  run.spacing_mm = facts.geometry.spacing_mm;
  run.isovalue = facts.isovalue;
  run.tool = facts.tool;
  run.algorithm = algorithm.id;
  run.mode = facts.haptics.mode;
  run.seed = facts.seed;
  run.tick_period_s = facts.tick_s;
  if (facts.labels) run.labels = facts.labels->labels();
  run.settings.push_back({std::string(kCommandLineKey), facts.command_line, ""});
  add_algorithm(run.settings, algorithm, facts.haptics, sample_points);
  add_milling(run.settings, facts.milling, facts.densities);
  add_limits(run.settings, facts.limits);
  return run;
}

}  // namespace osteomill
