#include "osteomill/haptics/algorithm_description.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace osteomill {

namespace {

constexpr const char* kInLabels = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_ ().,:+";
constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

std::string number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

}  // namespace

bool is_plain_name(std::string_view name) {
  return name.find_first_not_of(kPlain) == std::string_view::npos;
}

bool is_usable(const AlgorithmId& algorithm) {
  const std::string_view colour = algorithm.colour;
  return !algorithm.name.empty() && is_plain_name(algorithm.name) && !algorithm.label.empty() &&
         algorithm.label.find_first_not_of(kInLabels) == std::string::npos && colour.size() == 7 &&
         colour[0] == '#' && colour.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string_view::npos;
}

std::vector<AlgorithmId> sorted_unique(std::vector<AlgorithmId> algorithms) {
  std::sort(algorithms.begin(), algorithms.end());
  std::vector<AlgorithmId> unique;
  for (AlgorithmId& algorithm : algorithms) {
    if (std::find(unique.begin(), unique.end(), algorithm) == unique.end())
      unique.push_back(std::move(algorithm));
  }
  return unique;
}

const SettingDescription* setting_of_option(const AlgorithmDescription& algorithm, std::string_view option) {
  for (const SettingDescription& setting : algorithm.settings) {
    if (setting.option == option) return &setting;
  }
  return nullptr;
}

void require_in_range(const AlgorithmId& algorithm, const SettingDescription& setting, double value) {
  if (setting.range.contains(value)) return;
  throw std::invalid_argument(algorithm.name + ": " + setting.name + " must be " + range_text(setting.range) +
                              ", not " + number(value));
}

std::vector<SettingDescription> setting_values(const AlgorithmDescription& algorithm,
                                               const HapticSettings& settings) {
  std::vector<SettingDescription> values = algorithm.settings;
  const auto set = [&](const HapticSettings::Named& named, std::string FieldDescription::*name) {
    bool known = false;
    for (SettingDescription& setting : values) {
      if (setting.*name != named.setting) continue;
      require_in_range(algorithm.id, setting, named.value);
      setting.value = named.value;
      known = true;
    }
    return known;
  };
  for (const HapticSettings::Named& named : settings.named) {
    if (named.algorithm.empty()) set(named, &FieldDescription::option);
  }
  for (const HapticSettings::Named& named : settings.named) {
    if (named.algorithm == algorithm.id.name && !set(named, &FieldDescription::name)) {
      throw std::invalid_argument(algorithm.id.name + ": there is no setting " + named.setting);
    }
  }
  return values;
}

std::unique_ptr<HapticAlgorithm> make_algorithm(const AlgorithmDescription& algorithm,
                                                const HapticSettings& settings) {
  std::vector<double> values;
  for (const SettingDescription& setting : setting_values(algorithm, settings))
    values.push_back(setting.value);
  return algorithm.make(values);
}

}  // namespace osteomill
