#include "app/config_file.h"

#include <algorithm>
#include <vector>

#include "app/option_checks.h"
#include "app/toml_file.h"
#include <CLI/Error.hpp>
#include <fmt/core.h>

#include "osteomill/files/input_error.h"
#include "osteomill/haptics/algorithms.h"

namespace osteomill::app {

namespace {

constexpr const char* kConfigOption = "--config";

// What may stand in the file: the options without their dashes, and tables named after algorithms.
std::vector<std::string> keys_of(const CLI::App& command) {
  std::vector<std::string> keys;
  for (const std::string& name : option_names(command)) {
    if (name != kConfigOption && name != "--help") keys.push_back(name.substr(2));
  }
  if (command.get_option_no_throw("--set") != nullptr) {
    for (const std::string& name : algorithm_names()) keys.push_back(name);
  }
  return keys;
}

}  // namespace

void set_results(CLI::Option& option, const std::vector<std::string>& texts) {
  option.clear();
  for (const std::string& text : texts) option.add_result(text);
  option.run_callback();
}

namespace {

void give(CLI::Option& option, const toml::node& value, const std::string& file, const std::string& key) {
  try {
    for (const std::string& text : option_values(value, file, key)) option.add_result(text);
    option.run_callback();
  } catch (const CLI::Error& error) {
    throw InputError(file, fmt::format("line {}: {}", value.source().begin.line, error.what()));
  }
}

// A table named after an algorithm holds that algorithm's own settings; the command line's come last and so
// win.
void give_named_settings(CLI::Option& option, const std::string& algorithm, const toml::table& table,
                         const std::string& file) {
  const std::vector<std::string> said_before = option.results();
  std::vector<std::string> texts;
  for (auto&& [key, value] : table) {
    const std::string name(key.str());
    for (const std::string& text : option_values(value, file, name)) {
      texts.push_back(fmt::format("{}.{}={}", algorithm, name, text));
    }
    try {
      set_results(option, texts);
    } catch (const CLI::Error& error) {
      throw InputError(file, fmt::format("line {}: {}", value.source().begin.line, error.what()));
    }
  }
  texts.insert(texts.end(), said_before.begin(), said_before.end());
  set_results(option, texts);
}

}  // namespace

void add_config_option(CLI::App& command) {
  command.add_option(kConfigOption, "TOML file with any of these options as keys")->type_name("FILE");
}

void apply_config_file(CLI::App& command) {
  const CLI::Option* config = command.get_option(kConfigOption);
  if (config->count() == 0) return;
  const auto file = config->as<std::string>();
  for (auto&& [key, value] : read_toml(file)) {
    const std::string name(key.str());
    CLI::Option* named_settings = command.get_option_no_throw("--set");
    if (value.is_table() && named_settings != nullptr && find_algorithm(name) != nullptr) {
      give_named_settings(*named_settings, name, *value.as_table(), file);
      continue;
    }
    CLI::Option* option = command.get_option_no_throw("--" + name);
    if (option == nullptr || name == "config" || name == "help") {
      throw InputError(file, fmt::format("line {}: {} has no option {}{}", value.source().begin.line,
                                         command.get_name(), name, did_you_mean(name, keys_of(command))));
    }
    if (option->count() == 0) give(*option, value, file, name);
  }
}

}  // namespace osteomill::app
