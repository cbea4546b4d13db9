#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_setup.h"

namespace osteomill::app {

/// The options of every milling command.
struct MillingOptions {
  MillingSetup setup;
};

/// Copies from `given` to `setup` only the fields whose options were given on the command line.
void apply_given_options(const CLI::App& command, const MillingSetup& given, MillingSetup& setup);

/// Sets the setting "ALGORITHM.SETTING" to the number in `text`. Throws CLI::ValidationError, and sets
/// nothing, if the setting is unknown or the value out of range.
void set_algorithm_setting(HapticSettings& haptics, const std::string& name, const std::string& text);
/// Sets an option shared by algorithms, such as "stiffness". Throws CLI::ValidationError if the value is out
/// of range for every algorithm; an algorithm with a narrower range throws when it is made.
void set_shared_option(HapticSettings& haptics, const std::string& option, double value);
/// Returns the shared options, without dashes.
std::vector<std::string> shared_options();

/// Adds the tool, the algorithms' settings, milling, limits and --config to a command.
void add_milling_options(CLI::App& command, MillingOptions& options);

/// Switches to the law of constant energy if one of its options was given without --law. Throws
/// CLI::ValidationError if one was given with --law chips. Call it when all options are read.
void apply_implied_law(const CLI::App& command, MillingSetup& setup);

/// Adds --rate, which sets the length of a tick.
void add_rate_option(CLI::App& command, double& tick_s);

/// Adds --algorithm for one algorithm.
void add_algorithm_option(CLI::App& command, AlgorithmDescription& algorithm);
/// Adds --algorithm, which may repeat; the default is all of `algorithms`.
void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms);

}  // namespace osteomill::app
