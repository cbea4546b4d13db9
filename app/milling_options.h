#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_setup.h"

namespace osteomill::app {

/// The options that every command that mills has.
struct MillingOptions {
  MillingSetup setup;
};

/// Copies from `given` into `setup` those of its fields whose options stand on the command line, and no
/// others.
void take_given_options(const CLI::App& command, const MillingSetup& given, MillingSetup& setup);

/// Sets the algorithms' setting "ALGORITHM.SETTING" to what stands in `text`. Throws CLI::ValidationError,
/// and sets nothing, if there is no such setting or it has another range.
void set_own(HapticSettings& haptics, const std::string& name, const std::string& text);
/// Sets an option that algorithms share, "stiffness". Throws CLI::ValidationError if no algorithm takes that
/// number; one that does not says so when it is made.
void set_shared(HapticSettings& haptics, const std::string& option, double value);
/// Returns these options, without dashes.
std::vector<std::string> shared_options();

/// Adds the tool, the algorithms' settings, milling, limits and --config to a command.
void add_milling_options(CLI::App& command, MillingOptions& options);

/// Takes the law of constant energy if only its options were given. Throws CLI::ValidationError if one of
/// them was given with --law chips. Call it when all options are read.
void settle_law(const CLI::App& command, MillingSetup& setup);

/// Adds --rate, which sets the length of a tick.
void add_rate_option(CLI::App& command, double& tick_s);

/// Adds --algorithm for a command that works with one.
void add_algorithm_option(CLI::App& command, AlgorithmDescription& algorithm);
/// Adds --algorithm, which may repeat; none given means all of `algorithms`.
void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms);

}  // namespace osteomill::app
