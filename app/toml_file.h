#pragma once

#include <string>
#include <vector>

#include <toml++/toml.h>

namespace osteomill::app {

/// A TOML file as a table. Throws InputError naming the file, and the line where there is one.
toml::table read_toml(const std::string& file);

/// What the command line would have said in the place of this value: one text a value, of a list several.
/// Throws InputError, naming file, line and `key`, where it is neither a text, a number, true, false, nor a
/// list of them.
std::vector<std::string> option_values(const toml::node& value, const std::string& file,
                                       const std::string& key);

}  // namespace osteomill::app
