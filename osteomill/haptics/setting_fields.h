#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// Ties a setting's description to its place in an algorithm's own struct of settings. Made by
/// `setting_field`.
template <typename Settings>
struct SettingField {
  SettingDescription description;
  double (*get)(const Settings&);
  void (*set)(Settings&, double);
};

/// The field for the switch, number or choice that `place`, a lambda without captures, returns a reference
/// to.
template <typename Settings, typename Place>
SettingField<Settings> setting_field(SettingDescription description, Place /*place*/) {
  return {std::move(description),
          [](const Settings& settings) {
            Settings copy = settings;
            return static_cast<double>(Place{}(copy));
          },
          [](Settings& settings, double value) {
            auto& place = Place{}(settings);
            place = static_cast<std::remove_reference_t<decltype(place)>>(value);
          }};
}

/// Every setting at its value of the mode.
template <typename Settings>
Settings settings_in(Mode mode, std::span<const SettingField<Settings>> fields) {
  Settings settings;
  for (const SettingField<Settings>& field : fields) {
    field.set(settings, field.description.value_in(mode));
  }
  return settings;
}

/// Throws std::invalid_argument, naming algorithm and setting, where one is out of its range.
template <typename Settings>
void require_in_range(const AlgorithmId& algorithm, const Settings& settings,
                      std::span<const SettingField<Settings>> fields) {
  for (const SettingField<Settings>& field : fields) {
    require_in_range(algorithm, field.description, field.get(settings));
  }
}

/// Completes a description with these settings, and makes `Algorithm` from them.
template <typename Algorithm, typename Settings>
AlgorithmDescription with_settings(AlgorithmDescription description,
                                   std::span<const SettingField<Settings>> fields) {
  for (const SettingField<Settings>& field : fields) description.settings.push_back(field.description);
  description.make = [fields](std::span<const double> values) -> std::unique_ptr<HapticAlgorithm> {
    Settings settings;
    for (std::size_t n = 0; n < fields.size(); ++n) fields[n].set(settings, values[n]);
    return std::make_unique<Algorithm>(settings);
  };
  return description;
}

}  // namespace osteomill
