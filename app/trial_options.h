#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/session/simulated_operator.h"
#include "osteomill/study/trial_plan.h"

#include "app/milling_options.h"
#include "app/scan_options.h"

namespace osteomill::app {

/// The options that the commands that run section 8.2 share: milling, and the simulated hand with its task.
struct TrialOptions {
  MillingOptions milling;
  OperatorSettings hand;
  std::uint64_t seed = 1;
  std::optional<Vec3> entry_W_mm;
  std::optional<Vec3> direction_W;
};

}  // namespace osteomill::app

namespace osteomill {

/// Returns the texts of a trial's options: where the tool enters.
template <>
const std::vector<Field<app::TrialOptions, std::string>>& fields_of<app::TrialOptions, std::string>();

}  // namespace osteomill

namespace osteomill::app {

/// Adds --seconds, --push, --seed, --entry, --direction, the settings of hand and device, and all milling
/// options.
void add_trial_options(CLI::App& command, TrialOptions& options);

TrialSettings trial_settings(const TrialOptions& options);

/// Returns where the tool enters the bone of the scan of this name. Throws InputError if it cannot.
MillingEntry entry_into(const Volume& bone, const std::string& scan, const TrialOptions& options);

/// Returns the same place as entry_into, and warns on standard error if it is unlikely to be what the user
/// wants.
MillingEntry place_entry(const Volume& bone, const std::string& scan, const TrialOptions& options);

/// Warns of settings that are poor in a scan of this grid (setting_warnings), and throws as that does.
void warn_of_settings(const MillingSetup& setup, const GridGeometry& scan);

/// Returns the plan of a trial on a bone, which outlives it. Throws std::invalid_argument if the tool cannot
/// work in that bone, and as entry_into.
TrialPlan trial_plan(const LoadedBone& bone, const TrialOptions& options, const std::string& command_line);

}  // namespace osteomill::app
