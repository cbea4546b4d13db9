#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace osteomill::app {

/// The kind of values that a shell completes for an option or argument.
enum class Completion { kNothing, kWords, kFile, kFolder };

/// One option or argument of a command, for manual pages and shell completions.
struct OptionText {
  /// "--help" and "-h", or the single name of an argument.
  std::vector<std::string> names;
  /// The placeholder of the value: "mm", "FILE"; empty for a switch.
  std::string value;
  std::string description;
  /// The default value; empty if there is none or the description has it.
  std::string default_value;
  std::string group;
  bool is_required = false;
  bool may_repeat = false;
  Completion completion = Completion::kNothing;
  /// The values for kWords.
  std::vector<std::string> words;
};

/// One command, or the program itself.
struct CommandText {
  std::string name;
  std::string description;
  std::string group;
  /// Options; those of the group "Options", which every command has, come last.
  std::vector<OptionText> options;
  std::vector<OptionText> arguments;
};

/// Returns the program itself, followed by its commands.
std::vector<CommandText> command_texts(CLI::App& program);

/// Returns the distinct group names of `all`, in their order.
template <typename Text>
std::vector<std::string> groups_of(const std::vector<Text>& all) {
  std::vector<std::string> groups;
  for (const Text& one : all) {
    if (std::ranges::find(groups, one.group) == groups.end()) groups.push_back(one.group);
  }
  return groups;
}

}  // namespace osteomill::app
