#include "osteomill/report/settings_table.h"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

namespace osteomill {

namespace {

std::string text_of(const RunSetting& setting) {
  if (const double* number = std::get_if<double>(&setting.value)) return fmt::format("{}", *number);
  return std::get<std::string>(setting.value);
}

// The description's own fields and the further settings, alike.
std::vector<RunSetting> all_settings(const RunDescription& d) {
  std::vector<RunSetting> settings{
      {"program_version", d.program_version, ""},
      {"scan", d.scan_name, ""},
      {"voxels", fmt::format("{} × {} × {}", d.dims[0], d.dims[1], d.dims[2]), ""},
      {"spacing", fmt::format("{} × {} × {}", d.spacing_mm.x(), d.spacing_mm.y(), d.spacing_mm.z()), "mm"},
      {"isovalue", d.isovalue, ""},
      {"burr_radius", d.tool.burr_radius_mm, "mm"},
      {"shaft_radius", d.tool.shaft_radius_mm, "mm"},
      {"shaft_length", d.tool.shaft_length_mm, "mm"},
      {"mode", std::string(name_of(d.mode)), ""},
      {"seed", fmt::format("{}", d.seed), ""},
      {"tick_period", d.tick_period_s, "s"}};
  for (const RunSetting& setting : d.settings) {
    if (setting.key != kCommandLineKey && setting.key != kNotReachedKey) settings.push_back(setting);
  }
  return settings;
}

// Attributes of recordings are ASCII.
std::string raised(std::string unit) {
  for (const auto& [power, digit] : {std::pair("^2", "²"), std::pair("^3", "³")}) {
    if (const auto at = unit.find(power); at != std::string::npos) unit.replace(at, 2, digit);
  }
  return unit;
}

struct SettingLine {
  std::string key;
  std::string unit;
  // One for each recording; nothing where it does not have the setting.
  std::vector<std::optional<std::string>> values;
};

std::vector<SettingLine> collect(const std::vector<const Recording*>& recordings) {
  std::vector<SettingLine> lines;
  for (std::size_t n = 0; n < recordings.size(); ++n) {
    for (const RunSetting& setting : all_settings(recordings[n]->description)) {
      const auto same = [&](const SettingLine& l) { return l.key == setting.key && l.unit == setting.unit; };
      auto line = std::find_if(lines.begin(), lines.end(), same);
      if (line == lines.end()) {
        lines.push_back({setting.key, setting.unit, {}});
        lines.back().values.resize(recordings.size());
        line = lines.end() - 1;
      }
      line->values[n] = text_of(setting);
    }
  }
  return lines;
}

std::string value_of(const SettingLine& line, const std::vector<const Recording*>& recordings) {
  if (std::all_of(line.values.begin(), line.values.end(),
                  [&](const auto& v) { return v == line.values[0]; })) {
    return line.values[0].value_or("");
  }
  std::map<AlgorithmId, std::optional<std::string>> by_algorithm;
  bool algorithm_decides = true;
  std::string each;
  for (std::size_t n = 0; n < recordings.size(); ++n) {
    const RunDescription& d = recordings[n]->description;
    const auto [entry, is_new] = by_algorithm.emplace(d.algorithm, line.values[n]);
    if (!is_new && entry->second != line.values[n]) algorithm_decides = false;
    if (line.values[n]) {
      each += fmt::format("{}{}, {}, {}: {}", each.empty() ? "" : "; ", name_of(d.algorithm), name_of(d.mode),
                          d.phase, *line.values[n]);
    }
  }
  if (!algorithm_decides) return each;
  std::string text;
  for (const auto& [algorithm, value] : by_algorithm) {
    if (value) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", name_of(algorithm), *value);
  }
  return text;
}

}  // namespace

HtmlTable settings_table(const std::vector<const Recording*>& recordings) {
  HtmlTable table{{"Setting", "Value", "Unit"}, {}};
  for (const SettingLine& line : collect(recordings)) {
    table.rows.push_back(
        {html_escaped(line.key), html_escaped(value_of(line, recordings)), html_escaped(raised(line.unit))});
  }
  return table;
}

}  // namespace osteomill
