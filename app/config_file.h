#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace osteomill::app {

/// Adds `--config FILE.toml` to a command: each of its long options is also a key of the file, without the
/// dashes. The command line wins over the file.
void add_config_option(CLI::App& command);

/// Sets the options missing on the command line from the file. Call it after parsing, before the command
/// runs. Throws InputError naming the file, and the line if there is one, if the file is missing or not TOML,
/// or has a key or value that the command does not accept.
void apply_config_file(CLI::App& command);

/// Returns the given options of the groups Tool and Cutting.
std::vector<CLI::Option*> given_tool_options(CLI::App& command);

/// Replaces an option's values. `name` includes the dashes, or is the name of a positional. Throws CLI::Error
/// if the option does not accept the values.
void set_option(CLI::App& command, const std::string& name, const std::vector<std::string>& texts);

}  // namespace osteomill::app
