#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace osteomill {

/// A setting of an algorithm as people read and write it. A switch is 0 or 1, a choice its number.
struct SettingValue {
  std::string name;
  double value = 0;
  std::string unit;
};

/// Ties a setting's name to its place in an algorithm's settings, so that recordings list every setting and a
/// configuration file may set each on its own. Made by `setting_field`.
template <typename Settings>
struct SettingField {
  std::string_view name;
  std::string_view unit;
  double (*get)(const Settings&);
  /// False where the value does not fit the setting's type.
  bool (*set)(Settings&, double);
};

/// The field for the switch, number or choice that `place`, a lambda without captures, returns a reference
/// to.
template <typename Settings, typename Place>
constexpr SettingField<Settings> setting_field(std::string_view name, Place /*place*/,
                                               std::string_view unit = "") {
  return {name, unit,
          [](const Settings& settings) {
            Settings copy = settings;
            return static_cast<double>(Place{}(copy));
          },
          [](Settings& settings, double value) {
            auto& place = Place{}(settings);
            using T = std::remove_reference_t<decltype(place)>;
            constexpr bool kWhole = !std::is_floating_point_v<T>;
            // Counts and choices are small; a cast of more would not be defined.
            if (kWhole && !(value >= 0 && value <= 1e6)) return false;
            place = static_cast<T>(value);
            return static_cast<double>(place) == value;
          }};
}

/// Every setting by name, in the order of the fields.
template <typename Settings>
std::vector<SettingValue> describe_settings(const Settings& settings,
                                            std::span<const SettingField<Settings>> fields) {
  std::vector<SettingValue> values;
  for (const SettingField<Settings>& field : fields) {
    values.push_back({std::string(field.name), field.get(settings), std::string(field.unit)});
  }
  return values;
}

/// Sets one by name. Throws std::invalid_argument where there is no such setting, or the value does not fit
/// it: a switch takes 0 or 1, a count or a choice a whole number.
template <typename Settings>
void set_setting(Settings& settings, std::span<const SettingField<Settings>> fields, std::string_view name,
                 double value) {
  for (const SettingField<Settings>& field : fields) {
    if (field.name != name) continue;
    if (!field.set(settings, value)) {
      throw std::invalid_argument(std::string(name) + " does not take the value " + std::to_string(value));
    }
    return;
  }
  throw std::invalid_argument("there is no setting " + std::string(name));
}

}  // namespace osteomill
