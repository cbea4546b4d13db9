#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace osteomill::app {

/// Adds `--config FILE.toml` to a command: each of its long options is also a key of the file, without the
/// dashes. The command line wins over the file.
void add_config_option(CLI::App& command);

/// Gives the options that the command line left out what the file says. Call it after parsing, before the
/// command. Throws InputError naming the file, and the line if there is one, for a file that is not there,
/// is not TOML, or has a key or value that the command does not know.
void apply_config_file(CLI::App& command);

/// Returns the options about the tool and its cutting that were given.
std::vector<CLI::Option*> given_tool_options(CLI::App& command);

/// Replaces the values that an option was given before; `name` is with its dashes, or a positional's. Throws
/// CLI::Error if it does not take these.
void set_option(CLI::App& command, const std::string& name, const std::vector<std::string>& texts);

}  // namespace osteomill::app
