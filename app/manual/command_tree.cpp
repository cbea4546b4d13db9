#include "app/manual/command_tree.h"

#include <algorithm>
#include <cctype>
#include <iterator>

#include <CLI/Option.hpp>
#include <CLI/StringTools.hpp>

#include "app/option_checks.h"

namespace osteomill::app {

namespace {

constexpr const char* kLastGroup = "Options";
constexpr const char* kAnyText = "TEXT";
constexpr const char* kScan = "scan";
constexpr const char* kRecordings = "recordings";

bool is_word(const std::string& text) {
  return std::ranges::all_of(text, [](unsigned char c) { return std::islower(c) != 0; });
}

// Decides by the value's placeholder. In "N/mm|softest", the lower-case word is a literal.
void set_completion(OptionText& text) {
  const std::vector<std::string> parts = CLI::detail::split(text.value, '|');
  const auto has = [&](const char* part) { return std::ranges::find(parts, part) != parts.end(); };
  if (text.words.empty() && parts.size() > 1)
    std::ranges::copy_if(parts, std::back_inserter(text.words), is_word);
  if (!text.words.empty()) {
    text.completion = Completion::kWords;
  } else if (has("FILE") || has("RECORDING") || text.value == kScan || text.value == kRecordings) {
    text.completion = Completion::kFile;
  } else if (has("FOLDER")) {
    text.completion = Completion::kFolder;
  }
}

OptionText option_text(CLI::Option& option) {
  OptionText text;
  for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) text.names.push_back("-" + name);
  if (!is_switch(option)) text.value = option.get_type_name();
  if (text.names.empty()) {
    text.names = {option.get_name(true)};
    if (text.value == kAnyText) text.value = text.names.front();
  }
  text.description = option.get_description();
  // Some descriptions state the default themselves, because it depends on the machine.
  if (text.description.find("(default:") == std::string::npos) text.default_value = option.get_default_str();
  text.group = option.get_group();
  text.is_required = option.get_required();
  text.may_repeat = option.get_expected_max() > 1;
  text.words = choices_of(option);
  set_completion(text);
  return text;
}

CommandText command_text(CLI::App& command) {
  CommandText text{command.get_name(), command.get_description(), command.get_group(), {}, {}};
  for (CLI::Option* option : command.get_options())
    (option->nonpositional() ? text.options : text.arguments).push_back(option_text(*option));
  std::ranges::stable_sort(text.options, {}, [](const OptionText& one) { return one.group == kLastGroup; });
  return text;
}

}  // namespace

std::vector<CommandText> command_texts(CLI::App& program) {
  std::vector<CommandText> all{command_text(program)};
  for (CLI::App* command : program.get_subcommands({})) all.push_back(command_text(*command));
  return all;
}

}  // namespace osteomill::app
