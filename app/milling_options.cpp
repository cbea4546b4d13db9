#include "app/milling_options.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include <CLI/Error.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>

#include "osteomill/base/parse_number.h"

#include "app/config_file.h"
#include "app/option_checks.h"

namespace osteomill::app {

namespace {

// Adds an option that accepts one of `names` and passes it to `take`; help shows `usual` as the default.
void add_choice(CLI::App& command, const std::string& kind, const std::vector<std::string>& names,
                std::string_view usual, const std::string& type, const std::string& what,
                const std::function<void(const std::string&)>& take) {
  command.add_option_function<std::string>("--" + kind, take, what)
      ->check(one_of(kind, names))
      ->type_name(type)
      ->default_str(std::string(usual));
}

}  // namespace

namespace {

std::vector<std::string> setting_names(const AlgorithmDescription& algorithm) {
  std::vector<std::string> names;
  for (const SettingDescription& setting : algorithm.settings) names.push_back(setting.name);
  return names;
}

}  // namespace

void set_algorithm_setting(HapticSettings& haptics, const std::string& name, const std::string& text) {
  const std::size_t dot = name.find('.');
  HapticSettings::Named named{name.substr(0, dot), name.substr(dot + 1), 0};
  const AlgorithmDescription* algorithm = find_algorithm(named.algorithm);
  if (algorithm == nullptr) {
    throw CLI::ValidationError("--set", "there is no algorithm " + named.algorithm +
                                            did_you_mean(named.algorithm, algorithm_names()));
  }
  if (const std::vector<std::string> known = setting_names(*algorithm);
      std::find(known.begin(), known.end(), named.setting) == known.end()) {
    throw CLI::ValidationError("--set", fmt::format("{} has no setting {}{}", named.algorithm, named.setting,
                                                    did_you_mean(named.setting, known)));
  }
  const auto number = parse_number<double>(text);
  if (!number || std::isnan(*number)) throw CLI::ValidationError("--set", text + " is not a number");
  named.value = *number;
  try {
    make_algorithm(*algorithm, {.named = {named}});
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--set", error.what());
  }
  haptics.named.push_back(std::move(named));
}

void set_shared_option(HapticSettings& haptics, const std::string& option, double value) {
  std::string fault;
  bool is_taken = false;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    const SettingDescription* setting = setting_of_option(algorithm, option);
    if (setting == nullptr) continue;
    try {
      require_in_range(algorithm.id, *setting, value);
      is_taken = true;
    } catch (const std::invalid_argument& error) {
      fault = error.what();
    }
  }
  if (!is_taken) throw CLI::ValidationError("--" + option, fault);
  haptics.set_option(option, value);
}

std::vector<std::string> shared_options() {
  std::vector<std::string> options;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    for (const SettingDescription& setting : algorithm.settings) {
      if (!setting.option.empty() && std::ranges::find(options, setting.option) == options.end())
        options.push_back(setting.option);
    }
  }
  return options;
}

namespace {

// Returns "line-proxy: Stiffness of ... (N/mm); point-shell: ...".
std::string meaning_of_option(const std::string& option) {
  std::string text;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    const SettingDescription* setting = setting_of_option(algorithm, option);
    if (setting == nullptr) continue;
    text += (text.empty() ? "" : "; ") + algorithm.id.name + ": " + setting->doc;
    if (!setting->unit.empty()) text += " (" + setting->unit + ")";
  }
  return text;
}

// Parses "point-shell.scale=2".
void set_named(HapticSettings& haptics, const std::string& text) {
  const std::size_t dot = text.find('.'), equals = text.find('=');
  if (dot == std::string::npos || equals == std::string::npos || equals < dot)
    throw CLI::ValidationError("--set", text + " is not of the form ALGORITHM.SETTING=VALUE");
  set_algorithm_setting(haptics, text.substr(0, equals), text.substr(equals + 1));
}

void add_named_settings(CLI::App& command, HapticSettings& haptics) {
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&haptics](const std::vector<std::string>& texts) {
            std::erase_if(haptics.named, [](const auto& named) { return !named.algorithm.empty(); });
            for (const std::string& text : texts) set_named(haptics, text);
          },
          "Value of any algorithm's setting (docs/settings.md), as ALGORITHM.SETTING=VALUE; may repeat")
      ->type_name("SETTING");
}

// Adds one option for all settings that name it; only the algorithms' descriptions define them.
void add_shared_settings(CLI::App& command, HapticSettings& haptics) {
  for (const std::string& option : shared_options()) {
    const auto has_it = [&](const AlgorithmDescription& one) {
      return setting_of_option(one, option) != nullptr;
    };
    const AlgorithmDescription& first = *std::ranges::find_if(all_algorithms(), has_it);
    command
        .add_option_function<double>(
            "--" + option, [&haptics, option](double value) { set_shared_option(haptics, option, value); },
            meaning_of_option(option))
        ->type_name(setting_of_option(first, option)->range.whole ? "COUNT" : "NUMBER");
  }
}

}  // namespace

void add_milling_options(CLI::App& command, MillingOptions& options) {
  MillingSetup& setup = options.setup;
  command.option_defaults()->group("Tool");
  add_fields(command, setup, kToolField);
  command.option_defaults()->group("Settings of the algorithms");
  add_shared_settings(command, setup.haptics);
  add_named_settings(command, setup.haptics);
  command.option_defaults()->group("Cutting");
  add_fields(command, setup, kCuttingField, kDerivedField);
  command.option_defaults()->group("Limits of the device");
  add_fields(command, setup, kLimitField);
  command.option_defaults()->group("Options");
  add_config_option(command);
}

void apply_given_options(const CLI::App& command, const MillingSetup& given, MillingSetup& setup) {
  for (const Field<MillingSetup>& field : fields_of<MillingSetup>()) {
    if (!field.option.empty() && command.count("--" + field.option) > 0) field.set(setup, field.get(given));
  }
}

void add_rate_option(CLI::App& command, double& tick_s) {
  add_number(command, {"", "Hz", {100, 4000}, "Rate of the haptic loop", 0, "rate"}, number_text(1 / tick_s),
             [&tick_s](double rate_hz) { tick_s = 1 / rate_hz; });
}

void apply_implied_law(const CLI::App& command, MillingSetup& setup) {
  for (const char* option : {"--removal-rate", "--cutting-energy"}) {
    if (command.count(option) == 0 || setup.law == CuttingLaw::constant_energy) continue;
    if (command.count("--law") > 0)
      throw CLI::ValidationError(option, "applies to --law constant-energy, not to chips");
    setup.law = CuttingLaw::constant_energy;
  }
}

void add_algorithm_option(CLI::App& command, AlgorithmDescription& algorithm) {
  add_choice(command, "algorithm", algorithm_names(), algorithm.id.name, "NAME",
             fmt::format("Haptic algorithm: {}", fmt::join(algorithm_names(), ", ")),
             [&algorithm](const std::string& name) { algorithm = algorithm_named(name); });
}

void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms) {
  const std::string all = algorithms.size() > 1 ? "all" : algorithms.front().id.name;
  std::string what = fmt::format("Haptic algorithm: {}", fmt::join(algorithm_names(), ", "));
  if (algorithms.size() > 1) what += "; may repeat";
  command
      .add_option_function<std::vector<std::string>>(
          "--algorithm",
          [&algorithms](const std::vector<std::string>& chosen) {
            algorithms.clear();
            for (const std::string& name : chosen) {
              const AlgorithmDescription& algorithm = algorithm_named(name);
              const bool is_there = std::any_of(algorithms.begin(), algorithms.end(),
                                                [&](const auto& other) { return other.id == algorithm.id; });
              if (!is_there) algorithms.push_back(algorithm);
            }
          },
          what)
      ->check(one_of("algorithm", algorithm_names()))
      ->type_name("NAME")
      ->default_str(all);
}

}  // namespace osteomill::app
