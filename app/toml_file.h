#pragma once

#include <string>
#include <vector>

#include <toml++/toml.h>

#include "osteomill/base/input_error.h"

namespace osteomill::app {

/// Reads a TOML file of the user as a table, and notes it as an input (input_files.h). Throws InputError
/// naming the file, and the line if there is one.
toml::table read_toml(const std::string& file);
/// Reads a TOML file that the program writes itself. Throws as `read_toml` does.
toml::table parse_toml(const std::string& file);

/// A key of a table and what stands behind it, as long as the table lives.
struct TomlEntry {
  std::string key;
  const toml::node* value;
};
/// Returns the entries in the order of the file, because the library sorts them by name.
std::vector<TomlEntry> entries_of(const toml::table& table);
/// Returns the entries of a table of options. A table in it that is named after an algorithm holds that
/// algorithm's own settings, which become entries behind its name, "point-shell.scale".
std::vector<TomlEntry> options_of(const toml::table& table);
bool is_own_setting(const std::string& key);

/// Returns the error of a place in a file, with its line.
InputError error_at(const toml::node& place, const std::string& file, const std::string& reason);

/// Returns the texts that the command line would have in the place of this value: one text a value, for a
/// list several. Throws InputError, naming file, line and `key`, if it is neither a text, a number, true,
/// false, nor a list of at least one of them.
std::vector<std::string> option_values(const toml::node& value, const std::string& file,
                                       const std::string& key);

}  // namespace osteomill::app
