#include "osteomill/ct/read_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/work_progress.h"

#include "byte_source.h"
#include "dicom_file.h"
#include "header_text.h"
#include "label_table.h"
#include "volume_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

// Voxel count of a label value, and the label's index in order of value.
struct FoundLabel {
  std::size_t voxels = 0;
  LabelMap::LabelIndex place = 0;
};
using FoundLabels = std::map<int, FoundLabel>;

void check_is_label(const std::string& subject, float value) {
  constexpr float kMax = 1e6f;
  if (std::isfinite(value) && std::floor(value) == value && std::abs(value) <= kMax) return;
  throw InputError(
      subject,
      fmt::format("is not a label map: it holds {:g}, and labels are whole numbers up to a million", value));
}

FoundLabels find_labels(const std::string& subject, const std::vector<float>& values) {
  FoundLabels found;
  for (auto run = values.begin(); run != values.end();) {
    const auto end = std::find_if(run, values.end(), [&](float value) { return !(value == *run); });
    check_is_label(subject, *run);
    found[static_cast<int>(*run)].voxels += static_cast<std::size_t>(end - run);
    if (found.size() > LabelMap::kMaxLabels + 1) {
      throw InputError(subject, fmt::format("has more than {} labels", LabelMap::kMaxLabels));
    }
    run = end;
    WorkProgress::done(0);
  }
  found.erase(0);
  if (found.empty()) throw InputError(subject, "has no labels: all its voxels are 0");
  LabelMap::LabelIndex place = 0;
  for (auto& [value, label] : found) label.place = ++place;
  return found;
}

std::vector<LabelMap::LabelIndex> places_of(const std::vector<float>& values, const FoundLabels& found) {
  std::vector<LabelMap::LabelIndex> places;
  places.reserve(values.size());
  float last = 0;
  LabelMap::LabelIndex place = 0;
  for (const float value : values) {
    if (value != last) {
      last = value;
      const auto label = found.find(static_cast<int>(value));
      place = label == found.end() ? LabelMap::LabelIndex{0} : label->second.place;
    }
    places.push_back(place);
  }
  return places;
}

// Hues by the golden angle, so that consecutive labels differ.
Colour colour_of_place(LabelMap::LabelIndex place) {
  const double hue = std::fmod(0.09 + 0.381966 * place, 1.0);
  Colour colour{};
  for (std::size_t n = 0; n < 3; ++n) {
    const double away = std::abs(std::fmod(hue + static_cast<double>(n) / 3, 1.0) * 2 - 1);
    colour[n] =
        static_cast<std::uint8_t>(std::lround(255 * (0.25 + 0.65 * std::clamp(3 * away - 1, 0.0, 1.0))));
  }
  return colour;
}

bool is_called(const Label& label, const std::string& said) {
  return said == std::to_string(label.value) || lower(said) == lower(label.name);
}

// Marks the labels called `said` as no-go. Throws if there are none.
void mark_no_go(const std::string& subject, const std::string& said, std::vector<Label>& labels) {
  bool found = false;
  for (Label& label : labels) {
    if (!is_called(label, said)) continue;
    found = label.no_go = true;
  }
  if (found) return;
  constexpr std::size_t kMostNames = 12;
  std::vector<std::string> names;
  for (const Label& label : labels) names.push_back(fmt::format("{} {}", label.value, label.name));
  if (names.size() > kMostNames) {
    names.resize(kMostNames);
    names.emplace_back("...");
  }
  throw InputError(subject,
                   fmt::format("has no label \"{}\" for --no-go; it has {}", said, fmt::join(names, ", ")));
}

std::vector<Label> make_labels(const FoundLabels& found, const LabelTable& table, const LabelFiles& files) {
  std::vector<Label> labels;
  for (const auto& [value, entry] : found) {
    Label label{value, fmt::format("label {}", value), colour_of_place(entry.place)};
    if (const auto style = table.find(value); style != table.end()) {
      if (!style->second.name.empty()) label.name = style->second.name;
      label.colour = style->second.colour.value_or(label.colour);
    }
    labels.push_back(std::move(label));
  }
  for (const std::string& said : files.no_go) mark_no_go(files.map.string(), said, labels);
  return labels;
}

std::optional<std::string> not_in_table(const LabelTable& table, const std::vector<Label>& labels,
                                        const LabelFiles& files) {
  std::vector<int> missing;
  for (const Label& label : labels) {
    if (!table.contains(label.value)) missing.push_back(label.value);
  }
  if (missing.empty()) return std::nullopt;
  return fmt::format("{}: has no entry for label{} {} of the map", files.table.string(),
                     missing.size() > 1 ? "s" : "", fmt::join(missing, ", "));
}

std::string extent_text(const GridGeometry& geometry) {
  Vec3 least = Vec3::Constant(1e300), most = -least;
  for (int n = 0; n < 8; ++n) {
    const Vec3 corner_W = geometry.world_from_voxel(VoxelIndex{(n & 1) != 0 ? geometry.dims[0] - 1 : 0,
                                                               (n & 2) != 0 ? geometry.dims[1] - 1 : 0,
                                                               (n & 4) != 0 ? geometry.dims[2] - 1 : 0});
    least = least.cwiseMin(corner_W);
    most = most.cwiseMax(corner_W);
  }
  return fmt::format("{:.4g} to {:.4g}, {:.4g} to {:.4g}, {:.4g} to {:.4g} mm", least.x(), most.x(),
                     least.y(), most.y(), least.z(), most.z());
}

// Warns if more than 2 % of the labelled volume is outside the scan.
std::optional<std::string> cover_warning(const FoundLabels& found, const GridGeometry& own,
                                         const LabelMap& map, const std::string& subject) {
  std::size_t own_voxels = 0, scan_voxels = 0;
  for (const auto& [value, label] : found) own_voxels += label.voxels;
  for (const std::size_t count : map.voxel_counts()) scan_voxels += count;
  const double share = static_cast<double>(scan_voxels) * map.scan_geometry().voxel_volume_mm3() /
                       (static_cast<double>(own_voxels) * own.voxel_volume_mm3());
  if (share > 0.98) return std::nullopt;
  return fmt::format("{}: {:.0f} % of its labelled volume is outside the scan", subject, 100 * (1 - share));
}

// Labels on their own grid.
struct OwnLabels {
  const GridGeometry& geometry;
  std::vector<float> values;
  LabelTable table;
};

// Resamples labels to the grid of a scan. Errors and warnings name `subject`.
LabelsRead resample_labels(const GridGeometry& scan, const std::string& subject, OwnLabels own,
                           const LabelFiles& files) {
  if (!files.table.empty()) {
    LabelTable given = read_label_table(files.table);
    given.merge(own.table);
    own.table = std::move(given);
  }
  LabelsRead read;
  const FoundLabels found = find_labels(subject, own.values);
  std::vector<Label> labels = make_labels(found, own.table, files);
  if (!files.table.empty()) {
    if (auto warning = not_in_table(own.table, labels, files)) read.warnings.push_back(*std::move(warning));
  }
  const auto map =
      std::make_shared<const LabelMap>(std::move(labels), scan, own.geometry, places_of(own.values, found));
  if (map->box().empty()) {
    throw InputError(subject, fmt::format("does not overlap the scan: its extent is {}, the scan's {}",
                                          extent_text(own.geometry), extent_text(scan)));
  }
  if (auto warning = cover_warning(found, own.geometry, *map, subject))
    read.warnings.push_back(*std::move(warning));
  read.map = map;
  return read;
}

// Reads the labels of a DICOM segmentation.
LabelsRead read_segmentation_labels(const LabelFiles& files, const GridGeometry& scan,
                                    std::uint64_t max_memory_bytes) {
  const std::string subject = files.map.string();
  const ReadOptions options{.series = "", .max_memory_bytes = max_memory_bytes};
  const bool is_one_file = fs::is_regular_file(files.map) && lower(files.map.extension().string()) != ".zip";
  const std::optional<Scan> found =
      is_one_file ? read_dicom(files.map, options) : std::optional(read_scan(files.map, options));
  if (!found || found->labels.empty())
    throw InputError(
        subject,
        "is not a label map: neither a DICOM segmentation nor a NRRD, MetaImage or NIfTI file by its name");
  const Scan& own = *found;
  LabelsRead read = resample_labels(
      scan, subject, {own.grid.geometry(), every_nth_density(own.grid, 1), table_of(own.labels)}, files);
  for (const std::string& warning : own.warnings) read.warnings.push_back(subject + ": " + warning);
  return read;
}

}  // namespace

LabelsRead labels_in(const Scan& scan, const LabelFiles& files) {
  return resample_labels(scan.grid.geometry(), scan.name,
                         {scan.grid.geometry(), every_nth_density(scan.grid, 1), table_of(scan.labels)},
                         files);
}

bool is_label_file(const fs::path& path) {
  return volume_format_of(path) != nullptr;
}

LabelsRead read_labels(const LabelFiles& files, const GridGeometry& scan, std::uint64_t max_memory_bytes) {
  const std::string subject = files.map.string();
  std::error_code error;
  if (!fs::exists(files.map, error)) throw InputError(subject, "no such file");
  const VolumeFormat* const format = volume_format_of(files.map);
  try {
    if (format == nullptr) return read_segmentation_labels(files, scan, max_memory_bytes);
    VolumeHeader header = format->read_header(files.map);
    std::vector<float> values = read_volume(subject, header, max_memory_bytes);
    LabelsRead read = resample_labels(
        scan, subject, {header.geometry, std::move(values), label_table_of(subject, header)}, files);
    for (const std::string& warning : header.warnings) read.warnings.push_back(subject + ": " + warning);
    return read;
  } catch (const std::bad_alloc&) {
    throw InputError(subject, "does not fit into memory");
  }
}

}  // namespace osteomill
