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

/// The options shared by the commands that run section 8.2 of the paper: milling, and the simulated hand with
/// its task.
struct TrialOptions {
  MillingOptions milling;
  OperatorSettings hand;
  std::uint64_t seed = 1;
  std::optional<Vec3> entry_W_mm;
  std::optional<Vec3> direction_W;
};

}  // namespace osteomill::app

namespace osteomill {

/// Returns the text fields of a trial's options: entry point and direction.
template <>
const std::vector<Field<app::TrialOptions, std::string>>& fields_of<app::TrialOptions, std::string>();

}  // namespace osteomill

namespace osteomill::app {

/// Adds --seconds, --push, --seed, --entry, --direction, the settings of hand and device, and all milling
/// options.
void add_trial_options(CLI::App& command, TrialOptions& options);

TrialSettings trial_settings(const TrialOptions& options);

/// Returns the tool's entry into the bone. Throws InputError naming `scan` if there is none.
MillingEntry entry_into(const Volume& bone, const std::string& scan, const TrialOptions& options);

/// Returns the same entry as entry_into, and warns on standard error if it is probably not intended.
MillingEntry place_entry(const Volume& bone, const std::string& scan, const TrialOptions& options);

/// Warns of settings that are poor for a scan of this grid; throws as setting_warnings does.
void warn_of_settings(const MillingSetup& setup, const GridGeometry& scan);

/// Returns the plan of a trial on a bone, which must outlive it. Throws std::invalid_argument if the tool
/// cannot work in that bone, and as entry_into does.
TrialPlan trial_plan(const LoadedBone& bone, const TrialOptions& options, const std::string& command_line);

}  // namespace osteomill::app
