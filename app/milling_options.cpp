#include "app/milling_options.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

#include "app/config_file.h"
#include "app/option_checks.h"
#include <CLI/Error.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <fmt/format.h>

#include "osteomill/numbers/parse_number.h"

namespace osteomill::app {

namespace {

// `take` gets one of the names, which are all that may be given; where none is, the option shows `usual`.
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

// "point-shell.scale=2"
HapticSettings::Named named_setting(const std::string& text) {
  const std::size_t dot = text.find('.');
  const std::size_t equals = text.find('=');
  if (dot == std::string::npos || equals == std::string::npos || equals < dot) {
    throw CLI::ValidationError("--set", text + " is not of the form ALGORITHM.SETTING=VALUE");
  }
  HapticSettings::Named named{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1), 0};
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
  const std::string value = text.substr(equals + 1);
  const auto number = parsed_number<double>(value);
  if (!number || std::isnan(*number)) throw CLI::ValidationError("--set", value + " is not a number");
  named.value = *number;
  try {
    make_algorithm(*algorithm, {.named = {named}});
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--set", error.what());
  }
  return named;
}

// Checked by every algorithm that has it, so that none is refused later.
void set_shared(HapticSettings& haptics, const std::string& option, double value) {
  haptics.set_option(option, value);
  try {
    for (const AlgorithmDescription& algorithm : all_algorithms()) {
      if (const SettingDescription* setting = setting_of_option(algorithm, option)) {
        require_in_range(algorithm.id, *setting, value);
      }
    }
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--" + option, error.what());
  }
}

// "1 line-proxy: k of (6) and (10) (N/mm); 3 point-shell: ..."
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

void add_named_settings(CLI::App& command, HapticSettings& haptics) {
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&haptics](const std::vector<std::string>& texts) {
            std::erase_if(haptics.named, [](const auto& named) { return !named.algorithm.empty(); });
            for (const std::string& text : texts) haptics.named.push_back(named_setting(text));
          },
          "ALGORITHM.SETTING=VALUE, any setting of docs/settings.md; may repeat")
      ->type_name("SETTING");
}

// One option for all settings that name it, so that it stands in the algorithms' descriptions alone.
void add_shared_settings(CLI::App& command, HapticSettings& haptics) {
  std::vector<std::string> added;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    for (const SettingDescription& setting : algorithm.settings) {
      const std::string& option = setting.option;
      if (option.empty() || std::find(added.begin(), added.end(), option) != added.end()) continue;
      added.push_back(option);
      command
          .add_option_function<double>(
              "--" + option, [&haptics, option](double value) { set_shared(haptics, option, value); },
              meaning_of_option(option))
          ->type_name(setting.range.whole ? "COUNT" : "NUMBER");
    }
  }
}

#define OSTEOMILL_PLACE(type, field) [](MillingSetup& setup) -> type& { return setup.field; }

const MillingOption kOptions[] = {
    {"--burr-radius", "Tool", "mm", "Of the burr's sphere", OSTEOMILL_PLACE(double, tool.burr_radius_mm),
     true},
    {"--shaft-radius", "Tool", "mm", "Of the shaft", OSTEOMILL_PLACE(double, tool.shaft_radius_mm), true},
    {"--shaft-length", "Tool", "mm", "From the burr's centre", OSTEOMILL_PLACE(double, tool.shaft_length_mm),
     true},
    {"--spindle-speed", "Cutting", "rpm", "Of the burr", OSTEOMILL_PLACE(double, cutting.spindle_speed_rpm),
     true},
    {"--cutting-energy", "Cutting", "N.mm/mm³", "The work that removes bone of the reference density",
     OSTEOMILL_PLACE(double, cutting.specific_energy_Nmm_per_mm3), true},
    {"--removal-rate", "Cutting", "mm³/(N.s)",
     "kappa; else it follows from burr, spindle speed and cutting energy",
     OSTEOMILL_PLACE(std::optional<double>, removal_rate_mm3_per_Ns), true},
    {"--cutting-reaction", "Cutting", "", "The hand feels the burr pull along its rim, whose pole cuts less",
     OSTEOMILL_PLACE(bool, cutting_reaction), false},
    {"--force-limit", "Limits of the device", "N", "The most it is asked for",
     OSTEOMILL_PLACE(double, guard.limits.force_N), false},
    {"--torque-limit", "Limits of the device", "N.mm", "The most it is asked for",
     OSTEOMILL_PLACE(double, guard.limits.torque_Nmm), false},
    {"--passivity-controller", "Limits of the device", "",
     "Dampens a contact that has given the hand more energy than it took",
     OSTEOMILL_PLACE(bool, guard.passivity_controller), false},
};

#undef OSTEOMILL_PLACE

template <typename Number>
void add_option(CLI::App& command, const MillingOption& option, Number& value) {
  add_positive(command, option.name, value, option.unit, option.meaning);
}
void add_option(CLI::App& command, const MillingOption& option, bool& on) {
  const std::string name = option.name;
  command.add_flag(name + ",!--no-" + name.substr(2), on,
                   option.meaning + std::string(on ? " (on unless turned off)" : ""));
}

void add_options(CLI::App& command, MillingSetup& setup, std::string_view group) {
  command.option_defaults()->group(std::string(group));
  for (const MillingOption& option : kOptions) {
    if (option.group != group) continue;
    std::visit([&](auto place) { add_option(command, option, place(setup)); }, option.place);
  }
}

}  // namespace

void add_milling_options(CLI::App& command, MillingOptions& options) {
  MillingSetup& setup = options.setup;
  add_options(command, setup, "Tool");
  command.option_defaults()->group("Settings of the algorithms");
  add_shared_settings(command, setup.haptics);
  add_named_settings(command, setup.haptics);
  add_options(command, setup, "Cutting");
  add_options(command, setup, "Limits of the device");
  command.option_defaults()->group("Options");
  command.add_option("--seed", options.seed, "Of the hand's tremor, and of the hands that --seeds draws")
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()))
      ->type_name("NUMBER")
      ->capture_default_str();
  add_config_option(command);
}

std::span<const MillingOption> milling_options() {
  return kOptions;
}

void take_given_options(const CLI::App& command, MillingSetup given, MillingSetup& setup) {
  for (const MillingOption& option : kOptions) {
    if (command.count(option.name) > 0)
      std::visit([&](auto place) { place(setup) = place(given); }, option.place);
  }
}

void add_algorithm_option(CLI::App& command, AlgorithmDescription& algorithm) {
  add_choice(command, "algorithm", algorithm_names(), algorithm.id.name, "NAME",
             fmt::format("{}", fmt::join(algorithm_names(), ", ")),
             [&algorithm](const std::string& name) { algorithm = algorithm_named(name); });
}

void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms) {
  const std::string all = algorithms.size() > 1 ? "all" : algorithms.front().id.name;
  std::string what = fmt::format("{}", fmt::join(algorithm_names(), ", "));
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
