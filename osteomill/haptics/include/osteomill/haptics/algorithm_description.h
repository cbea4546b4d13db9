#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/haptics/haptic_algorithm.h"

namespace osteomill {

/// The values that the user gives to settings of the algorithms. A setting without one keeps the algorithm's
/// default.
struct HapticSettings {
  /// A value for one setting.
  struct Named {
    /// The algorithm whose setting of the name `setting` is meant. If empty, `setting` is an option
    /// (SettingDescription::option), and every algorithm that has a setting with this option takes the value.
    std::string algorithm;
    std::string setting;
    double value;
  };

  /// Values for options are applied first, then those for one algorithm, each in this order.
  std::vector<Named> named = {};

  /// Sets an option for every algorithm that has it, in the place of an earlier value:
  /// `set_option("stiffness", 2)`.
  void set_option(const std::string& option, double value) {
    clear_option(option);
    named.push_back({"", option, value});
  }
  /// Takes an option's value back, so that every algorithm has its default again.
  void clear_option(const std::string& option) {
    std::erase_if(named, [&](const Named& one) { return one.algorithm.empty() && one.setting == option; });
  }
};

/// The names and the colour by which people and files know an algorithm; a recording keeps them. Figures and
/// file names are made from it, so the name holds only letters, digits, '-' and '_', and the label also
/// spaces and any of ().,:+ (`is_usable`).
struct AlgorithmId {
  /// The name on the command line and in files: "point-shell". Two algorithms of one name are the same.
  std::string name;
  /// The label in figures and tables: "3 point-shell". Algorithms are listed in the order of their labels.
  std::string label;
  /// The colour of its curves, as HTML and gnuplot write it: "#c62828".
  std::string colour;

  friend bool operator==(const AlgorithmId& a, const AlgorithmId& b) { return a.name == b.name; }
  friend bool operator==(const AlgorithmId& a, std::string_view named) { return a.name == named; }
  friend bool operator<(const AlgorithmId& a, const AlgorithmId& b) { return a.label < b.label; }
};
/// Returns the algorithm's name, by which people choose it.
inline const std::string& name_of(const AlgorithmId& algorithm) {
  return algorithm.name;
}

/// Returns whether name, label and colour are such as recordings, figures and file names take.
bool is_usable(const AlgorithmId& algorithm);
/// Returns whether a name holds letters, digits, '-' and '_' alone.
bool is_plain_name(std::string_view name);

/// Returns each algorithm once, in the order of their labels.
std::vector<AlgorithmId> sorted_unique(std::vector<AlgorithmId> algorithms);

/// A setting of an algorithm. Its name is that in `--set ALGORITHM.NAME=VALUE`, configuration files and
/// recordings; every algorithm's setting of the same option is set by that option.
struct SettingDescription : FieldDescription {
  /// Its default; in the result of `setting_values`, the value in force.
  double value = 0;
};

/// An algorithm as programs choose, set and show it. Each of the project's stands in its own folder
/// (`algorithms.h` lists them); a program that links the library may make another and hand it to anything
/// that takes one.
struct AlgorithmDescription {
  AlgorithmId id;
  /// One line.
  std::string summary;
  /// The setting by which its resolution is chosen, and what people call that; empty if there is none.
  std::string resolution_setting = {};
  std::string resolution_name = {};
  /// Whether it holds the burr off structures that have a guard (WatchedStructure::guard_mm).
  bool has_guards = false;
  std::vector<SettingDescription> settings = {};
  /// Makes it with a value for each of `settings`, all within their ranges. Throws std::invalid_argument if
  /// values do not go together.
  std::function<std::unique_ptr<HapticAlgorithm>(std::span<const double> values)> make = {};
};

/// Returns the setting that an option of the command line sets; null if the algorithm has none.
const SettingDescription* setting_of_option(const AlgorithmDescription& algorithm, std::string_view option);

/// Throws std::invalid_argument, naming algorithm and setting, if the value does not lie in its range.
void require_in_range(const AlgorithmId& algorithm, const SettingDescription& setting, double value);

/// Returns every setting with the value that `make_algorithm` would use, in the order of the description.
/// Throws std::invalid_argument, naming algorithm and setting, if one is out of range or unknown.
std::vector<SettingDescription> setting_values(const AlgorithmDescription& algorithm,
                                               const HapticSettings& settings);

/// Makes the algorithm with these settings, still to be prepared. Throws as `setting_values` does.
std::unique_ptr<HapticAlgorithm> make_algorithm(const AlgorithmDescription& algorithm,
                                                const HapticSettings& settings);

}  // namespace osteomill
