#pragma once

#include <cstdint>
#include <string>
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

/// Adds --mode for a command that works in one mode, or in one or both.
void add_mode_option(CLI::App& command, Mode& mode);
void add_modes_option(CLI::App& command, std::vector<Mode>& modes);

/// Adds the tool, the algorithms' settings, milling, limits, --seed and --config to a command.
void add_milling_options(CLI::App& command, MillingOptions& options);

/// Adds --algorithm, which may repeat; none given means all.
void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms);

}  // namespace osteomill::app
