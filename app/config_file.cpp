#include "app/config_file.h"

#include <algorithm>
#include <vector>

#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"

#include "app/option_checks.h"
#include "app/toml_file.h"

namespace osteomill::app {

namespace {

constexpr const char* kConfigOption = "--config";
constexpr const char* kSetOption = "--set";

// Returns the keys that a file may have: options without their dashes, and tables named after algorithms.
std::vector<std::string> keys_of(const CLI::App& command) {
  std::vector<std::string> keys;
  for (const std::string& name : option_names(command)) {
    if (name != kConfigOption && name != "--help") keys.push_back(name.substr(2));
  }
  keys.insert(keys.end(), algorithm_names().begin(), algorithm_names().end());
  return keys;
}

}  // namespace

void set_option(CLI::App& command, const std::string& name, const std::vector<std::string>& texts) {
  CLI::Option& option = *command.get_option(name);
  option.clear();
  for (const std::string& text : texts) {
    // "--no-something" inverts true and false.
    const bool turns_off = is_switch(option) && (text == "true" || text == "false");
    option.add_result(turns_off ? option.get_flag_value(name.substr(2), text) : text);
  }
  option.run_callback();
}

void add_config_option(CLI::App& command) {
  command
      .add_option(kConfigOption,
                  "TOML file with any of these options as keys; the command line takes precedence")
      ->type_name("FILE");
}

std::vector<CLI::Option*> given_tool_options(CLI::App& command) {
  return command.get_options([](const CLI::Option* option) {
    return option->count() > 0 && (option->get_group() == "Tool" || option->get_group() == "Cutting");
  });
}

void apply_config_file(CLI::App& command) {
  const CLI::Option* config = command.get_option(kConfigOption);
  if (config->count() == 0) return;
  const auto file = config->as<std::string>();
  const std::vector<std::string> said_before = command.get_option(kSetOption)->results();
  // A burr's name in the file also sets sizes, so the options of the command line are applied once more.
  const std::vector<CLI::Option*> given = given_tool_options(command);
  std::vector<std::string> own;
  const toml::table table = read_toml(file);
  for (const TomlEntry& entry : options_of(table)) {
    const bool is_own = is_algorithm_setting(entry.key);
    const std::string name = is_own ? kSetOption : "--" + entry.key;
    const CLI::Option* option = command.get_option_no_throw(name);
    if (option == nullptr || option == config || entry.key == "help")
      throw error_at(*entry.value, file,
                     fmt::format("{} has no option {}{}", command.get_name(), entry.key,
                                 did_you_mean(entry.key, keys_of(command))));
    if (!is_own && option->count() > 0) continue;
    std::vector<std::string> texts = option_values(*entry.value, file, entry.key);
    if (is_own) {
      for (const std::string& text : texts) own.push_back(entry.key + "=" + text);
      texts = own;
    }
    try {
      set_option(command, name, texts);
    } catch (const CLI::Error& error) {
      throw error_at(*entry.value, file, error.what());
    }
  }
  for (CLI::Option* option : given) option->run_callback();
  if (own.empty()) return;
  // Settings of the command line come last and take precedence.
  own.insert(own.end(), said_before.begin(), said_before.end());
  set_option(command, kSetOption, own);
}

}  // namespace osteomill::app
