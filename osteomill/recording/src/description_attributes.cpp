#include <algorithm>
#include <cstdio>
#include <optional>
#include <set>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/base/positive.h"
#include "osteomill/haptics/algorithms.h"

#include "recording_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSettingsGroup = "settings";
constexpr const char* kLabelsGroup = "labels";
constexpr std::string_view kUnitSuffix = ".unit";

void require_usable_keys(const std::vector<RunSetting>& settings) {
  std::set<std::string> seen;
  for (const RunSetting& setting : settings) {
    if (setting.key.empty() || setting.key.ends_with(kUnitSuffix) || !seen.insert(setting.key).second) {
      throw std::invalid_argument("'" + setting.key +
                                  "' is not a valid key of a setting, or is already used");
    }
  }
}

// Creates a group that lists its attributes in order of creation.
Hdf5Handle create_ordered_group(const fs::path& path, hid_t file, const char* name) {
  const Hdf5Handle order(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_attr_creation_order(order.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  Hdf5Handle group(H5Gcreate2(file, name, H5P_DEFAULT, order.get(), H5P_DEFAULT), H5Gclose);
  if (!group.valid())
    throw InputError(path.string(), std::string("the group of ") + name + " cannot be written");
  return group;
}

void write_setting(const Attributes& write, const RunSetting& setting) {
  std::visit([&](const auto& value) { write.put(setting.key, value); }, setting.value);
  if (!setting.unit.empty()) write.put(setting.key + std::string(kUnitSuffix), setting.unit);
}

void write_settings(const fs::path& path, hid_t file, const std::vector<RunSetting>& settings) {
  const Hdf5Handle group = create_ordered_group(path, file, kSettingsGroup);
  const Attributes write(path, group.get());
  for (const RunSetting& setting : settings) write_setting(write, setting);
}

std::vector<RunSetting> read_settings(const fs::path& path, hid_t file) {
  const Hdf5Handle group(H5Gopen2(file, kSettingsGroup, H5P_DEFAULT), H5Gclose);
  if (!group.valid()) throw InputError(path.string(), "has no group of settings");
  const Attributes read(path, group.get());
  std::vector<RunSetting> settings;
  for (const std::string& name : read.names()) {
    if (name.ends_with(kUnitSuffix)) continue;
    RunSetting setting{name, 0.0, ""};
    if (read.is_text(name)) {
      setting.value = read.get<std::string>(name);
    } else {
      setting.value = read.real_or_infinite(name);
    }
    const std::string unit = name + std::string(kUnitSuffix);
    if (read.has(unit)) read.get(unit, setting.unit);
    settings.push_back(std::move(setting));
  }
  return settings;
}

void write_labels(const fs::path& path, hid_t file, const std::vector<Label>& labels) {
  if (labels.empty()) return;
  const Hdf5Handle group = create_ordered_group(path, file, kLabelsGroup);
  const Attributes write(path, group.get());
  for (const Label& label : labels) {
    const std::string value = std::to_string(label.value);
    write.put(value + ".name", label.name);
    write.put(value + ".colour", hex_colour(label));
    write.put(value + ".no_go", std::uint64_t{label.no_go});
  }
}

std::vector<Label> read_labels(const fs::path& path, hid_t file) {
  std::vector<Label> labels;
  if (H5Lexists(file, kLabelsGroup, H5P_DEFAULT) <= 0) return labels;
  const Hdf5Handle group(H5Gopen2(file, kLabelsGroup, H5P_DEFAULT), H5Gclose);
  const Attributes read(path, group.get());
  for (const std::string& name : read.names()) {
    if (!name.ends_with(".name")) continue;
    const std::string value = name.substr(0, name.find('.'));
    Label label;
    const auto number = parse_number<decltype(label.value)>(value);
    label.value = number.value_or(0);
    const std::string colour = read.get<std::string>(value + ".colour");
    unsigned rgb = 0;
    if (!number || labels.size() == LabelMap::kMaxLabels || colour.size() != 7 ||
        std::sscanf(colour.c_str(), "#%6x", &rgb) != 1) {
      throw InputError(path.string(), "has an invalid label '" + name + "'");
    }
    read.get(name, label.name);
    label.colour = {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
                    static_cast<std::uint8_t>(rgb)};
    label.no_go = read.get<std::uint64_t>(value + ".no_go") != 0;
    labels.push_back(std::move(label));
  }
  return labels;
}

// Throws InputError if grid, tick period or tool are invalid.
void require_sound(const fs::path& path, const RunDescription& run) {
  constexpr double kMaxVoxels = 1e12;
  const auto refuse = [&](const std::string& reason) { throw InputError(path.string(), reason); };
  if (!is_positive(run.tick_period_s)) refuse("the attribute 'tick_period_s' is not a positive number");
  double voxels = 1;
  for (const int count : run.dims) voxels *= std::max(0, count);
  if (!(voxels >= 1 && voxels <= kMaxVoxels)) refuse("the attribute 'dims' is not a valid scan size");
  if (!(run.spacing_mm.minCoeff() > 0)) refuse("the attribute 'spacing_mm' is not three positive numbers");
  if (!run.direction.isUnitary(1e-3)) refuse("its axes are not orthonormal");
  try {
    require_valid(run.tool);
  } catch (const std::invalid_argument& error) {
    refuse(error.what());
  }
}

}  // namespace

void write_description(const fs::path& path, hid_t file, const RunDescription& description) {
  require_usable_keys(description.settings);
  if (!is_usable(description.algorithm) || !is_plain_name(description.phase)) {
    throw std::invalid_argument("'" + description.algorithm.name + "', '" + description.phase +
                                "': invalid name of an algorithm or a phase");
  }
  const Attributes write(path, file);
  visit_attributes(description,
                   [&](const RunAttribute& of, const auto& value) { write.put(of.name, value); });
  write_settings(path, file, description.settings);
  write_labels(path, file, description.labels);
}

void add_setting(const fs::path& path, hid_t file, const RunSetting& setting) {
  const Hdf5Handle group(H5Gopen2(file, kSettingsGroup, H5P_DEFAULT), H5Gclose);
  if (!group.valid()) throw InputError(path.string(), "has no group of settings");
  write_setting(Attributes(path, group.get()), setting);
}

RunDescription read_description(const fs::path& path, hid_t file) {
  const Attributes read(path, file);
  RunDescription run;
  visit_attributes(run, [&](const RunAttribute& of, auto&& value) { read.get(of.name, value); });
  if (!is_usable(run.algorithm))
    throw InputError(path.string(), "has an invalid name, label or colour of its algorithm");
  if (!is_plain_name(run.phase)) throw InputError(path.string(), "the attribute 'phase' is not a plain name");
  require_sound(path, run);
  run.settings = read_settings(path, file);
  run.labels = read_labels(path, file);
  return run;
}

}  // namespace osteomill
