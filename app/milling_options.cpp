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

#include "osteomill/haptics/make_algorithm.h"

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
  const auto algorithm = algorithm_named(text.substr(0, dot));
  if (!algorithm) throw CLI::ValidationError("--set", text.substr(0, dot) + " is no algorithm");
  HapticSettings::Named named{*algorithm, text.substr(dot + 1, equals - dot - 1), 0};
  const std::string value = text.substr(equals + 1);
  if (value == "true" || value == "false") {
    named.value = value == "true" ? 1 : 0;
  } else if (!CLI::detail::lexical_cast(value, named.value) || std::isnan(named.value)) {
    throw CLI::ValidationError("--set", value + " is not a number, true or false");
  }
  HapticSettings alone;
  alone.named = {named};
  try {
    make_algorithm(*algorithm, alone);
  } catch (const std::invalid_argument& error) {
    throw CLI::ValidationError("--set", error.what());
  }
  return named;
}

void add_named_settings(CLI::App& command, HapticSettings& haptics) {
  command
      .add_option_function<std::vector<std::string>>(
          "--set",
          [&haptics](const std::vector<std::string>& texts) {
            haptics.named.clear();
            for (const std::string& text : texts) haptics.named.push_back(named_setting(text));
          },
          "ALGORITHM.SETTING=VALUE, any setting of docs/algorithms.md; may repeat")
      ->type_name("SETTING");
}

}  // namespace

void add_milling_options(CLI::App& command, MillingOptions& options) {
  MillingSetup& setup = options.setup;
  add_positive(command, "--burr-radius", setup.tool.burr_radius_mm, "mm");
  add_positive(command, "--shaft-radius", setup.tool.shaft_radius_mm, "mm");
  add_positive(command, "--shaft-length", setup.tool.shaft_length_mm, "mm");
  add_positive(command, "--stiffness", setup.haptics.stiffness_N_per_mm,
               "N/mm: the spring of 1 and 2, the virtual coupling of 3");
  add_positive(command, "--torsional-stiffness", setup.haptics.torsional_stiffness_Nmm_per_rad,
               "N mm/rad: the rotational virtual coupling of 3");
  add_positive(command, "--vertices", setup.haptics.vertices, "Vertices of algorithm 1");
  add_positive(command, "--slices", setup.haptics.slices, "Slices of algorithm 2");
  add_positive(command, "--shell-scale", setup.haptics.shell_scale,
               "Coarseness of algorithm 3's shell; 1 is every surface voxel");
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

void add_algorithm_option(CLI::App& command, std::vector<AlgorithmId>& algorithms) {
  std::vector<std::string> names;
  for (const AlgorithmId id : kAllAlgorithms) names.emplace_back(name_of(id));
  command
      .add_option_function<std::vector<std::string>>(
          "--algorithm",
          [&algorithms](const std::vector<std::string>& chosen) {
            algorithms.clear();
            for (const std::string& name : chosen) {
              const AlgorithmId id = *algorithm_named(name);
              if (std::find(algorithms.begin(), algorithms.end(), id) == algorithms.end())
                algorithms.push_back(id);
            }
          },
          "Only this one; may repeat")
      ->check(CLI::IsMember(names));
}

}  // namespace osteomill::app
