#include "app/milling_options.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>

#include "app/config_file.h"
#include "app/positive_number.h"
#include <CLI/Error.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

#include "osteomill/haptics/algorithms.h"

namespace osteomill::app {

void add_mode_option(CLI::App& command, Mode& mode) {
  command
      .add_option_function<std::string>(
          "--mode", [&mode](const std::string& name) { mode = *mode_named(name); },
          "'paper' as published, 'steady' with every improvement")
      ->check(CLI::IsMember({"paper", "steady"}))
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
          "'paper' as published, 'steady' with every improvement, or 'both'")
      ->check(CLI::IsMember({"paper", "steady", "both"}))
      ->default_str(std::string(name_of(modes.front())));
}

namespace {

// "point-shell.look-ahead=false"
HapticSettings::Named named_setting(const std::string& text) {
  const std::size_t dot = text.find('.');
  const std::size_t equals = text.find('=');
  if (dot == std::string::npos || equals == std::string::npos || equals < dot) {
    throw CLI::ValidationError("--set", text + " is not of the form ALGORITHM.SETTING=VALUE");
  }
  HapticSettings::Named named{text.substr(0, dot), text.substr(dot + 1, equals - dot - 1), 0};
  const AlgorithmDescription* algorithm = find_algorithm(named.algorithm);
  if (algorithm == nullptr) throw CLI::ValidationError("--set", named.algorithm + " is no algorithm");
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
  add_positive(command, "--burr-radius", setup.tool.burr_radius_mm, "mm");
  add_positive(command, "--shaft-radius", setup.tool.shaft_radius_mm, "mm");
  add_positive(command, "--shaft-length", setup.tool.shaft_length_mm, "mm");
  add_shared_settings(command, setup.haptics);
  add_named_settings(command, setup.haptics);
  add_positive(command, "--spindle-speed", setup.cutting.spindle_speed_rpm, "rpm");
  add_positive(command, "--cutting-energy", setup.cutting.specific_energy_Nmm_per_mm3,
               "N mm/mm^3, the work that removes bone of the reference density");
  add_positive(command, "--removal-rate", setup.removal_rate_mm3_per_Ns,
               "kappa, mm^3/(N s); else from burr, spindle speed and cutting energy");
  add_positive(command, "--force-limit", setup.limits.force_N, "N, the most the device is asked for");
  add_positive(command, "--torque-limit", setup.limits.torque_Nmm, "N mm");
  command.add_option("--seed", options.seed, "Of the hand's tremor, and of the hands that --seeds draws")
      ->capture_default_str();
  add_config_option(command);
}

void add_algorithm_option(CLI::App& command, std::vector<AlgorithmDescription>& algorithms) {
  const std::string all = algorithms.size() > 1 ? "all" : algorithms.front().id.name;
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
          "Only this one; may repeat")
      ->check(CLI::IsMember(algorithm_names()))
      ->default_str(all);
}

}  // namespace osteomill::app
