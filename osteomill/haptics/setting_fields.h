#pragma once

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

namespace osteomill {

/// A setting of an algorithm as people read and write it. A switch is 0 or 1.
struct SettingValue {
  std::string name;
  double value = 0;
  std::string unit;
};

/// Ties a setting's name to its place in an algorithm's settings, so that recordings list every setting and a
/// configuration file may set each on its own.
template <typename Settings>
struct SettingField {
  std::string_view name;
  std::variant<bool& (*)(Settings&), int& (*)(Settings&), double& (*)(Settings&)> place;
  std::string_view unit = "";
};

/// Every setting by name, in the order of the fields.
template <typename Settings>
std::vector<SettingValue> describe_settings(Settings settings,
                                            std::span<const SettingField<Settings>> fields) {
  std::vector<SettingValue> values;
  for (const SettingField<Settings>& field : fields) {
    const double value =
        std::visit([&](auto place) { return static_cast<double>(place(settings)); }, field.place);
    values.push_back({std::string(field.name), value, std::string(field.unit)});
  }
  return values;
}

/// Sets one by name. Throws std::invalid_argument where there is no such setting, a switch is given something
/// other than 0 or 1, or a whole number something between.
template <typename Settings>
void set_setting(Settings& settings, std::span<const SettingField<Settings>> fields, std::string_view name,
                 double value) {
  for (const SettingField<Settings>& field : fields) {
    if (field.name != name) continue;
    const auto assign = [&](auto place) {
      using T = std::remove_reference_t<decltype(place(settings))>;
      place(settings) = static_cast<T>(value);
      if (static_cast<double>(place(settings)) == value) return;
      const bool is_switch = std::is_same_v<T, bool>;
      throw std::invalid_argument(std::string(name) +
                                  (is_switch ? " is a switch: true or false" : " takes a whole number"));
    };
    std::visit(assign, field.place);
    return;
  }
  throw std::invalid_argument("there is no setting " + std::string(name));
}

}  // namespace osteomill
