#include "app/config_file.h"

#include <algorithm>
#include <vector>

#include "app/option_checks.h"
#include "app/toml_file.h"
#include <CLI/Error.hpp>
#include <fmt/core.h>

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
  keys.insert(keys.end(), algorithm_names().begin(), algorithm_names().end());
  return keys;
}

}  // namespace

void set_results(CLI::Option& option, const std::vector<std::string>& texts) {
  option.clear();
  for (const std::string& text : texts) option.add_result(text);
  option.run_callback();
}

void add_config_option(CLI::App& command) {
  command.add_option(kConfigOption, "TOML file with any of these options as keys")->type_name("FILE");
}

void apply_config_file(CLI::App& command) {
  const CLI::Option* config = command.get_option(kConfigOption);
  if (config->count() == 0) return;
  const auto file = config->as<std::string>();
  CLI::Option& own_settings = *command.get_option("--set");
  const std::vector<std::string> said_before = own_settings.results();
  std::vector<std::string> own;
  const toml::table table = read_toml(file);
  for (const TomlEntry& entry : options_of(table)) {
    const bool is_own = is_own_setting(entry.key);
    CLI::Option* option = is_own ? &own_settings : command.get_option_no_throw("--" + entry.key);
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
      set_results(*option, texts);
    } catch (const CLI::Error& error) {
      throw error_at(*entry.value, file, error.what());
    }
  }
  if (own.empty()) return;
  // The command line's come last and so win.
  own.insert(own.end(), said_before.begin(), said_before.end());
  set_results(own_settings, own);
}

}  // namespace osteomill::app
