#include "app/milling_options.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

#include "app/config_file.h"
#include "app/nearest_word.h"
#include "app/positive_number.h"
#include <CLI/Error.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>
#include <fmt/core.h>

#include "osteomill/haptics/algorithms.h"

namespace osteomill::app {

void add_mode_option(CLI::App& command, Mode& mode) {
  command
      .add_option_function<std::string>(
          "--mode", [&mode](const std::string& name) { mode = *mode_named(name); },
          "paper as published, steady with every improvement")
      ->check(one_of("mode", {"paper", "steady"}))
      ->type_name("MODE")
      ->default_str(std::string(name_of(mode)));
}

void add_modes_option(CLI::App& command, std::vector<Mode>& modes) {
  command
      .add_option_function<std::string>(
          "--mode",
          [&modes](const std::string& name) {
            const auto one = mode_named(name);
            modes = one ? std::vector{*one} : std::vector{Mode::paper, Mode::steady};
          },
          "paper as published, steady with every improvement, or both")
      ->check(one_of("mode", {"paper", "steady", "both"}))
      ->type_name("MODE")
      ->default_str(std::string(name_of(modes.front())));
}

namespace {

std::vector<std::string> setting_names(const AlgorithmDescription& algorithm) {
  std::vector<std::string> names;
  for (const SettingDescription& setting : algorithm.settings) names.push_back(setting.name);
  return names;
}

// "point-shell.guarded-move=false"
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
  if (value == "true" || value == "false") {
    named.value = value == "true" ? 1 : 0;
  } else if (!CLI::detail::lexical_cast(value, named.value) || std::isnan(named.value)) {
    throw CLI::ValidationError("--set", value + " is not a number, true or false");
  }
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
    text += (text.empty() ? "" : "; ") + algorithm.id.name + ": " + setting->meaning;
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

}  // namespace

void add_milling_options(CLI::App& command, MillingOptions& options) {
  MillingSetup& setup = options.setup;
  command.option_defaults()->group("Tool");
  add_positive(command, "--burr-radius", setup.tool.burr_radius_mm, "mm", "Of the burr's sphere");
  add_positive(command, "--shaft-radius", setup.tool.shaft_radius_mm, "mm", "Of the shaft");
  add_positive(command, "--shaft-length", setup.tool.shaft_length_mm, "mm", "From the burr's centre");
  command.option_defaults()->group("Settings of the algorithms");
  add_shared_settings(command, setup.haptics);
  add_named_settings(command, setup.haptics);
  command.option_defaults()->group("Cutting");
  add_positive(command, "--spindle-speed", setup.cutting.spindle_speed_rpm, "rpm", "Of the burr");
  add_positive(command, "--cutting-energy", setup.cutting.specific_energy_Nmm_per_mm3, "N.mm/mm^3",
               "The work that removes bone of the reference density");
  add_positive(command, "--removal-rate", setup.removal_rate_mm3_per_Ns, "mm^3/(N.s)",
               "kappa; else it follows from burr, spindle speed and cutting energy");
  command.add_flag("--cutting-reaction,!--no-cutting-reaction", setup.cutting_reaction,
                   fmt::format("The hand feels the burr pull along its rim, whose pole cuts less{}",
                               setup.cutting_reaction ? " (on unless turned off)" : ""));
  command.option_defaults()->group("Limits of the device");
  add_positive(command, "--force-limit", setup.guard.limits.force_N, "N", "The most it is asked for");
  add_positive(command, "--torque-limit", setup.guard.limits.torque_Nmm, "N.mm", "The most it is asked for");
  command.add_flag("--passivity-controller,!--no-passivity-controller", setup.guard.passivity_controller,
                   "Dampens a contact that has given the hand more energy than it took");
  command.option_defaults()->group("Options");
  command.add_option("--seed", options.seed, "Of the hand's tremor, and of the hands that --seeds draws")
      ->check(whole_number(0, std::numeric_limits<std::uint64_t>::max()))
      ->type_name("NUMBER")
      ->capture_default_str();
  add_config_option(command);
}

void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms) {
  const std::string all = algorithms.size() > 1 ? "all" : algorithms.front().id.name;
  std::string what;
  for (const std::string& name : algorithm_names()) what += (what.empty() ? "" : ", ") + name;
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
