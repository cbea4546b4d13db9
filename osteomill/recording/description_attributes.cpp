#include "osteomill/recording/description_attributes.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <utility>

#include "osteomill/files/input_error.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/numbers/positive.h"
#include "osteomill/recording/hdf5.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kSettingsGroup = "settings";
constexpr const char* kLabelsGroup = "labels";
constexpr std::string_view kUnitSuffix = ".unit";
constexpr std::array kAxes{"axis_i", "axis_j", "axis_k"};
constexpr std::array kOriginAttributes{
    std::pair{"date_utc", &Origin::date_utc}, std::pair{"host", &Origin::host},
    std::pair{"system", &Origin::system},     std::pair{"processor", &Origin::processor},
    std::pair{"compiler", &Origin::compiler}, std::pair{"build", &Origin::build},
};
constexpr std::string_view kUnknownColour = "#888888";

void require_usable_keys(const std::vector<RunSetting>& settings) {
  std::set<std::string> seen;
  for (const RunSetting& setting : settings) {
    if (setting.key.empty() || setting.key.ends_with(kUnitSuffix) || !seen.insert(setting.key).second) {
      throw std::invalid_argument("'" + setting.key + "' cannot be the key of a setting, or is one already");
    }
  }
}

// Whose attributes are listed in the order in which they were made.
Hdf5Handle create_ordered_group(const fs::path& path, hid_t file, const char* name) {
  const Hdf5Handle order(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
  H5Pset_attr_creation_order(order.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
  Hdf5Handle group(H5Gcreate2(file, name, H5P_DEFAULT, order.get(), H5P_DEFAULT), H5Gclose);
  if (!group.valid())
    throw InputError(path.string(), std::string("the group of ") + name + " cannot be written");
  return group;
}

void write_settings(const fs::path& path, hid_t file, const std::vector<RunSetting>& settings) {
  const Hdf5Handle group = create_ordered_group(path, file, kSettingsGroup);
  const AttributeWriter write(path, group.get());
  for (const RunSetting& setting : settings) {
    if (const double* number = std::get_if<double>(&setting.value)) {
      write.real(setting.key, *number);
    } else {
      write.text(setting.key, std::get<std::string>(setting.value));
    }
    if (!setting.unit.empty()) write.text(setting.key + std::string(kUnitSuffix), setting.unit);
  }
}

std::vector<RunSetting> read_settings(const fs::path& path, hid_t file) {
  const Hdf5Handle group(H5Gopen2(file, kSettingsGroup, H5P_DEFAULT), H5Gclose);
  if (!group.valid()) throw InputError(path.string(), "has no group of settings");
  const AttributeReader read(path, group.get());
  std::vector<RunSetting> settings;
  for (const std::string& name : read.names()) {
    if (name.ends_with(kUnitSuffix)) continue;
    RunSetting setting{name, 0.0, ""};
    if (read.is_text(name)) {
      setting.value = read.text(name);
    } else {
      setting.value = read.real(name);
    }
    const std::string unit = name + std::string(kUnitSuffix);
    if (read.has(unit)) setting.unit = read.text(unit);
    settings.push_back(std::move(setting));
  }
  return settings;
}

void write_labels(const fs::path& path, hid_t file, const std::vector<Label>& labels) {
  if (labels.empty()) return;
  const Hdf5Handle group = create_ordered_group(path, file, kLabelsGroup);
  const AttributeWriter write(path, group.get());
  for (const Label& label : labels) {
    const std::string value = std::to_string(label.value);
    write.text(value + ".name", label.name);
    write.text(value + ".colour", hex_colour(label));
    write.unsigned_integer(value + ".no_go", label.no_go ? 1 : 0);
  }
}

std::vector<Label> read_labels(const fs::path& path, hid_t file) {
  std::vector<Label> labels;
  if (H5Lexists(file, kLabelsGroup, H5P_DEFAULT) <= 0) return labels;
  const Hdf5Handle group(H5Gopen2(file, kLabelsGroup, H5P_DEFAULT), H5Gclose);
  const AttributeReader read(path, group.get());
  for (const std::string& name : read.names()) {
    if (!name.ends_with(".name")) continue;
    const std::string value = name.substr(0, name.find('.'));
    Label label;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), label.value);
    const std::string colour = read.text(value + ".colour");
    unsigned rgb = 0;
    if (error != std::errc() || end != value.data() + value.size() || labels.size() == LabelMap::kMaxLabels ||
        colour.size() != 7 || std::sscanf(colour.c_str(), "#%6x", &rgb) != 1) {
      throw InputError(path.string(), "has a label that cannot be used: '" + name + "'");
    }
    label.name = read.text(name);
    label.colour = {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
                    static_cast<std::uint8_t>(rgb)};
    label.no_go = read.unsigned_integer(value + ".no_go") != 0;
    labels.push_back(std::move(label));
  }
  return labels;
}

// Recordings from before algorithms' labels were kept hold the project's own algorithms only; of others the
// name serves.
AlgorithmId read_algorithm(const fs::path& path, const AttributeReader& read) {
  AlgorithmId algorithm{read.text("algorithm"), "", ""};
  if (read.has("algorithm_label")) {
    algorithm.label = read.text("algorithm_label");
    algorithm.colour = read.text("algorithm_colour");
  } else if (const AlgorithmDescription* known = find_algorithm(algorithm.name)) {
    algorithm = known->id;
  } else {
    algorithm.label = algorithm.name;
    algorithm.colour = kUnknownColour;
  }
  if (!is_usable(algorithm)) {
    throw InputError(path.string(), "its algorithm has a name, label or colour that cannot be used");
  }
  return algorithm;
}

template <typename Value>
Value require_known(const fs::path& path, std::optional<Value> value, const std::string& name) {
  if (!value) throw InputError(path.string(), "'" + name + "' is not known here");
  return *value;
}

}  // namespace

void write_description(const fs::path& path, hid_t file, const RunDescription& description) {
  require_usable_keys(description.settings);
  if (!is_usable(description.algorithm) || !is_plain_name(description.segment)) {
    throw std::invalid_argument("'" + description.algorithm.name + "', '" + description.segment +
                                "': an algorithm or a segment that cannot be recorded by that name");
  }
  const AttributeWriter write(path, file);
  write.text("program_version", description.program_version);
  for (const auto& [name, member] : kOriginAttributes) write.text(name, description.made.*member);
  write.text("scan_name", description.scan_name);
  write.integers("dims", description.dims);
  write.vector("spacing_mm", description.spacing_mm);
  write.vector("origin_mm", description.origin_mm);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    write.vector(kAxes[static_cast<std::size_t>(axis)], Vec3(description.direction.col(axis)));
  write.unsigned_integer("scan_hash", description.scan_hash);
  write.unsigned_integer("label_map_hash", description.label_map_hash);
  write.real("isovalue", description.isovalue);
  write.real("burr_radius_mm", description.tool.burr_radius_mm);
  write.real("shaft_radius_mm", description.tool.shaft_radius_mm);
  write.real("shaft_length_mm", description.tool.shaft_length_mm);
  write.text("algorithm", description.algorithm.name);
  write.text("algorithm_label", description.algorithm.label);
  write.text("algorithm_colour", description.algorithm.colour);
  write.text("mode", std::string(name_of(description.mode)));
  write.text("phase", description.segment);
  write.unsigned_integer("seed", description.seed);
  write.real("tick_period_s", description.tick_period_s);
  write_settings(path, file, description.settings);
  write_labels(path, file, description.labels);
}

RunDescription read_description(const fs::path& path, hid_t file) {
  const AttributeReader read(path, file);
  RunDescription description;
  description.program_version = read.text("program_version");
  description.scan_name = read.text("scan_name");
  description.dims = read.integers("dims");
  description.spacing_mm = read.vector("spacing_mm");
  // Version 2 has none of these.
  if (read.has("scan_hash")) {
    for (const auto& [name, member] : kOriginAttributes) description.made.*member = read.text(name);
    description.origin_mm = read.vector("origin_mm");
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      description.direction.col(axis) = read.vector(kAxes[static_cast<std::size_t>(axis)]);
    description.scan_hash = read.unsigned_integer("scan_hash");
    description.label_map_hash = read.unsigned_integer("label_map_hash");
  }
  description.isovalue = read.real("isovalue");
  description.tool = {read.real("burr_radius_mm"), read.real("shaft_radius_mm"),
                      read.real("shaft_length_mm")};
  description.algorithm = read_algorithm(path, read);
  description.segment = read.text("phase");
  if (!is_plain_name(description.segment)) {
    throw InputError(path.string(), "the attribute 'phase' is not a plain name");
  }
  const std::string mode = read.text("mode");
  description.mode = require_known(path, mode_named(mode), "mode " + mode);
  description.seed = read.unsigned_integer("seed");
  description.tick_period_s = read.real("tick_period_s");
  if (!is_positive(description.tick_period_s)) {
    throw InputError(path.string(), "the attribute 'tick_period_s' is not a positive number");
  }
  description.settings = read_settings(path, file);
  description.labels = read_labels(path, file);
  return description;
}

}  // namespace osteomill
