#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace osteomill::app {

/// The kind of values that a shell offers for an option or argument.
enum class Completion { kNothing, kWords, kFile, kFolder };

/// One option or argument of a command, as its manual page and the completions of shells have it.
struct OptionText {
  /// "--help" and "-h", or the one name of an argument.
  std::vector<std::string> names;
  /// The word that stands for the value: "mm", "FILE"; empty for a switch.
  std::string value;
  std::string description;
  /// The value if none is given; empty if there is none, or if the description has it.
  std::string usual;
  std::string group;
  bool is_required = false;
  bool may_repeat = false;
  Completion completion = Completion::kNothing;
  /// The values that kWords offers.
  std::vector<std::string> words;
};

/// One command, or the program itself.
struct CommandText {
  std::string name;
  std::string description;
  std::string group;
  /// Those of the group "Options", which every command has, last.
  std::vector<OptionText> options;
  std::vector<OptionText> arguments;
};

/// Returns the program itself, and then its commands.
std::vector<CommandText> command_texts(CLI::App& program);

/// Returns the names of the groups of `all`, each once and in their order.
template <typename Text>
std::vector<std::string> groups_of(const std::vector<Text>& all) {
  std::vector<std::string> groups;
  for (const Text& one : all) {
    if (std::ranges::find(groups, one.group) == groups.end()) groups.push_back(one.group);
  }
  return groups;
}

}  // namespace osteomill::app
