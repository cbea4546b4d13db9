#pragma once

#include <memory>
#include <span>
#include <utility>

#include "osteomill/haptics/algorithm_description.h"

namespace osteomill {

/// Ties a setting's description to its place in an algorithm's own struct of settings. Made by
/// `setting_field`.
template <typename Settings>
struct SettingField {
  SettingDescription description;
  void (*set)(Settings&, double);
};

template <typename Place>
struct PlaceOf;
template <typename Settings, typename Value>
struct PlaceOf<Value Settings::*> {
  using Struct = Settings;
  using Type = Value;
};

/// The field for a number or a choice: `setting_field<&Settings::push_N>({...})`.
template <auto kPlace>
auto setting_field(SettingDescription description) {
  using Place = PlaceOf<decltype(kPlace)>;
  return SettingField<typename Place::Struct>{std::move(description),
                                              [](typename Place::Struct& settings, double value) {
                                                settings.*kPlace = static_cast<typename Place::Type>(value);
                                              }};
}

/// Returns every setting at its default.
template <typename Settings>
Settings default_settings(std::span<const SettingField<Settings>> fields) {
  Settings settings;
  for (const SettingField<Settings>& field : fields) field.set(settings, field.description.value);
  return settings;
}

/// Completes a description with these settings, and makes `Algorithm` from them. `fields` is not copied: what
/// it refers to must outlive the description and all its copies (a static array, for example).
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
