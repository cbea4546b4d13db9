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

/// Values that the user assigns to settings of the algorithms. All other settings keep their defaults.
struct HapticSettings {
  /// One assigned value.
  struct Named {
    /// Name of the algorithm. If empty, `setting` is an option (SettingDescription::option), and the value
    /// applies to every algorithm that has a setting with this option.
    std::string algorithm;
    std::string setting;
    double value;
  };

  /// Values for options are applied first, then those for one algorithm, each in this order.
  std::vector<Named> named = {};

  /// Sets an option for every algorithm that has it. Replaces an earlier value.
  /// Example: `set_option("stiffness", 2)`.
  void set_option(const std::string& option, double value) {
    clear_option(option);
    named.push_back({"", option, value});
  }
  /// Removes an option's value, so that every algorithm uses its default again.
  void clear_option(const std::string& option) {
    std::erase_if(named, [&](const Named& one) { return one.algorithm.empty() && one.setting == option; });
  }
};

/// Identifies an algorithm to people and in files; stored in recordings. Figures and file names are made from
/// it, so the name may contain only letters, digits, '-' and '_', and the label also spaces and any of ().,:+
/// (`is_usable`).
struct AlgorithmId {
  /// The name on the command line and in files: "point-shell". Algorithms with equal names are the same.
  std::string name;
  /// The label in figures and tables: "3 point-shell". Algorithms are sorted by label.
  std::string label;
  /// The colour of its curves, in HTML and gnuplot notation: "#c62828".
  std::string colour;

  friend bool operator==(const AlgorithmId& a, const AlgorithmId& b) { return a.name == b.name; }
  friend bool operator==(const AlgorithmId& a, std::string_view named) { return a.name == named; }
  friend bool operator<(const AlgorithmId& a, const AlgorithmId& b) { return a.label < b.label; }
};
/// Returns the algorithm's name.
inline const std::string& name_of(const AlgorithmId& algorithm) {
  return algorithm.name;
}

/// Returns whether name, label and colour are valid in recordings, figures and file names.
bool is_usable(const AlgorithmId& algorithm);
/// Returns whether a name contains only letters, digits, '-' and '_'.
bool is_plain_name(std::string_view name);

/// Returns each algorithm once, sorted by label.
std::vector<AlgorithmId> sorted_unique(std::vector<AlgorithmId> algorithms);

/// A setting of an algorithm. Its name is used in `--set ALGORITHM.NAME=VALUE`, configuration files and
/// recordings. An option sets every algorithm's setting with that option.
struct SettingDescription : FieldDescription {
  /// Its default; in the result of `setting_values`, the effective value.
  double value = 0;
};

/// An algorithm as programs select, configure and display it. The project's own are listed in `algorithms.h`,
/// each in a folder of its own. A program that links the library may define another and pass it to any
/// function that takes one.
struct AlgorithmDescription {
  AlgorithmId id;
  /// A one-line summary.
  std::string summary;
  /// The setting that controls the resolution, and its display name; empty if there is none.
  std::string resolution_setting = {};
  std::string resolution_name = {};
  /// True if it keeps the burr off structures that have a guard (WatchedStructure::guard_mm).
  bool has_guards = false;
  std::vector<SettingDescription> settings = {};
  /// Creates the algorithm from one value for each of `settings`, all within their ranges. Throws
  /// std::invalid_argument if the values are inconsistent.
  std::function<std::unique_ptr<HapticAlgorithm>(std::span<const double> values)> make = {};
};

/// Returns the setting of a command-line option; null if the algorithm has none.
const SettingDescription* setting_of_option(const AlgorithmDescription& algorithm, std::string_view option);

/// Throws std::invalid_argument, naming algorithm and setting, if the value is out of range.
void require_in_range(const AlgorithmId& algorithm, const SettingDescription& setting, double value);

/// Returns every setting with the value that `make_algorithm` would use, in the order of the description.
/// Throws std::invalid_argument, naming algorithm and setting, if one is out of range or unknown.
std::vector<SettingDescription> setting_values(const AlgorithmDescription& algorithm,
                                               const HapticSettings& settings);

/// Creates the algorithm with these settings, not yet prepared. Throws like `setting_values`.
std::unique_ptr<HapticAlgorithm> make_algorithm(const AlgorithmDescription& algorithm,
                                                const HapticSettings& settings);

}  // namespace osteomill
