#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/haptics/algorithms.h"
#include "osteomill/session/milling_setup.h"

namespace osteomill::app {

/// What every command that mills has in common.
struct MillingOptions {
  MillingSetup setup;
  std::uint64_t seed = 1;
};

/// An option of a MillingSetup: all that the command line, files for --config and replays know of it.
struct MillingOption {
  /// With its dashes; a switch is also turned off by --no-NAME.
  const char* name;
  const char* group;
  /// Empty for a switch; all others take positive numbers.
  const char* unit;
  const char* meaning;
  std::variant<double& (*)(MillingSetup&), std::optional<double>& (*)(MillingSetup&),
               bool& (*)(MillingSetup&)>
      place;
  /// A recording is of one scan, milled with one tool: this is its own, and a replay of it takes no other.
  bool of_the_recording;
};
std::span<const MillingOption> milling_options();

/// Copies from `given` into `setup` those milling options that stand on the command line, and no others.
void take_given_options(const CLI::App& command, MillingSetup given, MillingSetup& setup);

/// Adds the tool, the algorithms' settings, milling, limits, --seed and --config to a command.
void add_milling_options(CLI::App& command, MillingOptions& options);

/// Adds --algorithm for a command that works with one.
void add_algorithm_option(CLI::App& command, AlgorithmDescription& algorithm);
/// Adds --algorithm, which may repeat; none given means all of `algorithms`.
void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms);

}  // namespace osteomill::app
