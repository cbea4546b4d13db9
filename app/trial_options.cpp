#include "app/trial_options.h"

#include <optional>
#include <string>

#include <CLI/Option.hpp>

#include "app/option_checks.h"
#include "app/progress.h"

namespace osteomill::app {

namespace {

void add_vector(CLI::App& command, const std::string& name, std::vector<double>& value,
                const std::string& what) {
  command.add_option(name, value, what)->delimiter(',')->expected(3)->type_name("X,Y,Z");
}

std::optional<Vec3> as_vector(const std::vector<double>& numbers) {
  if (numbers.empty()) return std::nullopt;
  return Vec3(numbers[0], numbers[1], numbers[2]);
}

}  // namespace

void add_trial_options(CLI::App& command, TrialOptions& options) {
  command.option_defaults()->group("The hand and its device");
  add_vector(command, "--entry", options.entry_mm,
             "From where the tool enters, in mm; else the top of the bone");
  add_vector(command, "--direction", options.direction, "Which way it enters; else 0,0,-1");
  add_fields(command, options.hand);
  add_milling_options(command, options.milling);
}

TrialSettings trial_settings(const TrialOptions& options) {
  TrialSettings trial(options.milling.setup, options.hand);
  trial.hand_and_device.handle.limits = trial.guard.limits;
  trial.hand_and_device.seed = options.milling.seed;
  return trial;
}

MillingEntry entry_into(const Volume& bone, const TrialOptions& options) {
  return osteomill::place_entry(bone, options.milling.setup.tool, as_vector(options.entry_mm),
                                as_vector(options.direction));
}

MillingEntry place_entry(const Volume& bone, const TrialOptions& options) {
  const MillingEntry entry = entry_into(bone, options);
  for (const std::string& warning : entry_warnings(bone, options.milling.setup.tool, entry)) warn(warning);
  return entry;
}

void warn_of_doubts(const MillingSetup& setup, const GridGeometry& scan) {
  for (const std::string& doubt : doubts_about(setup, scan)) warn(doubt);
}

TrialPlan trial_plan(const LoadedBone& bone, const TrialOptions& options, const std::string& command_line) {
  require_workable(options.milling.setup.tool, bone.volume.geometry());
  return {bone.volume,
          bone.name,
          estimate_densities(bone.volume),
          place_entry(bone.volume, options),
          trial_settings(options),
          command_line};
}

}  // namespace osteomill::app
