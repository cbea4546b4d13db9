#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace osteomill {

/// `paper` is what the paper says; `steady` the same algorithm with named improvements.
enum class Mode : unsigned char { paper, steady };

/// As written on the command line and in files: "paper", "steady".
std::string_view name_of(Mode mode);
std::optional<Mode> mode_named(std::string_view name);

/// What the user says of the algorithms' settings. What is left open takes each algorithm's own value for the
/// mode.
struct HapticSettings {
  struct Named {
    /// Of this algorithm, by the setting's own name. Empty: of every algorithm that has a setting with an
    /// option of that name (SettingDescription::option).
    std::string algorithm;
    std::string setting;
    double value;
  };

  Mode mode = Mode::steady;
  /// Options are applied first, then what is said of one algorithm, each in this order.
  std::vector<Named> named = {};

  /// For every algorithm that has it, in the place of what was said before: `set_option("stiffness", 2)`.
  void set_option(const std::string& option, double value) {
    clear_option(option);
    named.push_back({"", option, value});
  }
  /// Leaves it open again.
  void clear_option(const std::string& option) {
    std::erase_if(named, [&](const Named& one) { return one.algorithm.empty() && one.setting == option; });
  }
};

}  // namespace osteomill
