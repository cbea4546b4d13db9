#pragma once

#include <string>
#include <vector>

#include <toml++/toml.h>

#include "osteomill/base/input_error.h"

namespace osteomill::app {

/// Reads a user's TOML file and protects it as an input (input_files.h). Throws InputError naming the file,
/// and the line if there is one.
toml::table read_toml(const std::string& file);
/// Reads a TOML file that the program writes itself. Throws as `read_toml` does.
toml::table parse_toml(const std::string& file);

/// A key of a table and its value; valid as long as the table.
struct TomlEntry {
  std::string key;
  const toml::node* value;
};
/// Returns the entries in the order of the file; the library sorts them by name.
std::vector<TomlEntry> entries_of(const toml::table& table);
/// Returns the entries of a table of options. Settings in a nested table named after an algorithm become
/// entries with its name as a prefix, "point-shell.scale".
std::vector<TomlEntry> options_of(const toml::table& table);
bool is_algorithm_setting(const std::string& key);

/// Returns an error that names the file and the line of `place`.
InputError error_at(const toml::node& place, const std::string& file, const std::string& reason);

/// Returns the value as command-line arguments: one text, or several for a list. Throws InputError, naming
/// file, line and `key`, unless it is a text, a number, true, false, or a list of at least one of them.
std::vector<std::string> option_values(const toml::node& value, const std::string& file,
                                       const std::string& key);

}  // namespace osteomill::app
