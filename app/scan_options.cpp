#include "app/scan_options.h"

#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "osteomill/base/csv_field.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/parse_number.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/volume/builtin_phantoms.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/label_scan.h"

#include "app/memory_limit.h"
#include "app/option_checks.h"
#include "app/progress.h"

namespace osteomill {

namespace {

Vec3 spacing_of(const std::string& given) {
  Vec3 spacing_mm;
  const auto numbers = csv_fields(given);
  for (std::size_t n = 0; n < 3 && numbers.size() == 3; ++n) {
    const auto number = parse_finite(numbers[n]);
    if (!number || *number <= 0) break;
    spacing_mm[static_cast<Eigen::Index>(n)] = *number;
    if (n == 2) return spacing_mm;
  }
  throw std::invalid_argument(given + " is not three positive numbers separated by commas");
}

}  // namespace

template <>
const std::vector<Field<app::ScanOptions>>& fields_of<app::ScanOptions>() {
  using S = app::ScanOptions;
  static const std::vector<Field<S>> all = [] {
    std::vector<Field<S>> fields{
        {{"", "density", NumberRange::finite(),
          "Isovalue: voxels of a higher density are bone (default: suggested from the scan)",
          app::kBoneChoiceField | app::kBoneField, "iso"},
         [](const S& s) { return s.isovalue.value_or(std::numeric_limits<double>::quiet_NaN()); },
         [](S& s, double value) { s.isovalue = value; }}};
    for (Field<S>& piece : fields_within<S>(&S::pieces, fields_of<PieceChoice>())) {
      piece.flags |= app::kBoneChoiceField | app::kBoneField;
      fields.push_back(std::move(piece));
    }
    return fields;
  }();
  return all;
}

template <>
const std::vector<Field<app::ScanOptions, std::string>>& fields_of<app::ScanOptions, std::string>() {
  using S = app::ScanOptions;
  const auto text = [](const char* name, const char* option, const char* type, unsigned of, const char* doc) {
    return FieldDescription{name, type, {}, doc, of | app::kBoneField, option};
  };
  FieldDescription no_go = text("scan.no_go", "no-go", "LABEL,...", app::kNoGoField,
                                "Labels that the burr must not touch, by name or value");
  no_go.range = NumberRange::count(1);
  static const std::vector<Field<S, std::string>> all{
      field<S>(
          text("scan.series", "series", "SERIES", app::kSourceField,
               "DICOM series to read, by its number in the list that info prints (3, or 3.1 for one of "
               "several volumes in a series) or by the start of its UID (default: the largest CT)"),
          [](auto& s) -> auto& { return s.read.series; }),
      {text("scan.spacing", "spacing", "X,Y,Z", app::kSourceField,
            "Voxel spacing of a stack of PNG or TIFF images, mm: between columns, rows and slices"),
       [](const S& s) {
         return s.read.spacing_mm ? fmt::format("{}", fmt::join(*s.read.spacing_mm, ",")) : std::string();
       },
       [](S& s, const std::string& given) { s.read.spacing_mm = spacing_of(given); }},
      {text("", "as", "scan|labels", app::kSourceField,
            "Read the values as densities (scan) or as labels, all of which are bone (default: decided by "
            "header and content; densities if --iso is given)"),
       [](const S& s) { return s.as_labels ? *s.as_labels ? "labels" : "scan" : ""; },
       [](S& s, const std::string& kind) {
         app::require_word("kind", kind, {"scan", "labels"});
         s.as_labels = kind == "labels";
       }},
      field<S>(
          text("scan.labels", "labels", "FILE", app::kBoneChoiceField,
               "Label map of the scan (NRRD, .seg.nrrd, NIfTI, MetaImage, DICOM segmentation), on any grid"),
          [](auto& s) -> auto& { return s.labels.map; }),
      field<S>(
          text("scan.label_table", "label-table", "FILE", app::kBoneChoiceField,
               "Names and colours of the labels: a 3D Slicer colour table or an ITK-SNAP label file"),
          [](auto& s) -> auto& { return s.labels.table; }),
      {no_go, [](const S& s) { return fmt::format("{}", fmt::join(s.labels.no_go, ",")); },
       [](S& s, const std::string& labels) {
         const auto names = csv_fields(labels);
         s.labels.no_go.assign(names.begin(), names.end());
       }}};
  return all;
}

}  // namespace osteomill

namespace osteomill::app {

void add_bone_options(CLI::App& command, ScanOptions& options) {
  add_fields(command, options, kBoneChoiceField, kBoneChoiceField);
  add_texts(command, options, kBoneChoiceField);
}

void add_scan_source(CLI::App& command, ScanOptions& options, const std::string& default_scan) {
  command
      .add_option(
          "scan", options.scan,
          "DICOM folder or file, NRRD, MetaImage or NIfTI file, folder of PNG or TIFF slices, zip file of "
          "any of these, or builtin:tooth, builtin:layers or builtin:mastoid; the default is " +
              default_scan)
      ->check(not_empty());
  add_texts(command, options, kSourceField);
  command
      .add_option_function<double>(
          "--max-memory",
          [&bytes = options.read.max_memory_bytes](double gigabytes) {
            bytes = static_cast<std::uint64_t>(gigabytes * 1e9);
          },
          "Memory limit for a scan and all data derived from it; a scan that needs more is refused (default: "
          "the machine's memory, or the program's cgroup v2 limit)")
      ->check(number_of({.min = 1e-3, .max = 1e6}))
      ->type_name("GB");
}

void add_scan_options(CLI::App& command, ScanOptions& options, const std::string& default_scan) {
  command.option_defaults()->group("Scan");
  add_scan_source(command, options, default_scan);
  add_bone_options(command, options);
  add_texts(command, options, kNoGoField);
}

namespace {

constexpr std::string_view kBuiltinPrefix = "builtin:";

}  // namespace

bool is_builtin(const std::string& scan) {
  return scan.empty() || scan.starts_with(kBuiltinPrefix);
}

namespace {

bool is_builtin_tooth(const std::string& scan) {
  return scan.empty() || scan == fmt::format("{}tooth", kBuiltinPrefix);
}

// Returns the built-in phantom of this name; null for the tooth and other scans. Throws InputError if
// "builtin:" is followed by an unknown name.
const BuiltinPhantom* phantom_of(const std::string& scan) {
  if (is_builtin_tooth(scan) || !is_builtin(scan)) return nullptr;
  const std::string name = scan.substr(kBuiltinPrefix.size());
  std::vector<std::string> names{"tooth"};
  for (const BuiltinPhantom& phantom : builtin_phantoms()) {
    if (phantom.name == name) return &phantom;
    names.emplace_back(phantom.name);
  }
  throw InputError(scan, "is not a built-in scan" + did_you_mean(name, names));
}

// Examines the values unless the options or the file's header decide.
LabelGuess guess_content(const ScanOptions& options, const Scan& scan) {
  const auto of = [](bool labels) { return labels ? LabelGuess::labels : LabelGuess::densities; };
  if (options.as_labels) return of(*options.as_labels);
  if (options.bone_fingerprint != 0 && options.isovalue) {
    DensityGrid labelled = bone_of_labels(scan.grid, *options.isovalue);
    if (!options.pieces.keeps_all()) discard_pieces(labelled, *options.isovalue, options.pieces);
    return of(fingerprint_of(scan.grid) != options.bone_fingerprint &&
              fingerprint_of(labelled) == options.bone_fingerprint);
  }
  if (options.isovalue) return LabelGuess::densities;
  return scan.is_labels ? LabelGuess::labels : guess_labels(scan.grid);
}

}  // namespace

Scan open_scan(const ScanOptions& options) {
  if (is_builtin_tooth(options.scan))
    return {builtin_tooth(options.refinement), kBuiltinTooth, "made up", {}};
  if (const BuiltinPhantom* phantom = phantom_of(options.scan))
    return {phantom->make(), options.scan, "made up", {}};
  Scan scan = read_scan(options.scan, options.read);
  const bool kind_is_known = scan.is_labels || options.as_labels || options.bone_fingerprint != 0;
  const LabelGuess guess = guess_content(options, scan);
  scan.is_labels = guess == LabelGuess::labels;
  const auto warn_first = [&](std::string warning) {
    scan.warnings.insert(scan.warnings.begin(), std::move(warning));
  };
  if (scan.is_labels) {
    warn_first(fmt::format("{} a label map: all labelled voxels are read as bone of one density{}",
                           kind_is_known ? "is" : "looks like",
                           kind_is_known ? "" : "; --as scan reads its values as densities"));
  } else if (guess == LabelGuess::unclear && !scan.in_hounsfield_units) {
    warn_first(
        "may be a label map: its values are few whole numbers, which are read as densities; --as labels "
        "reads them as labels");
  }
  return scan;
}

SuggestedIsovalue suggested_isovalue(const ScanOptions& options, const Scan& scan) {
  if (is_builtin_tooth(options.scan)) {
    return {kBuiltinToothIsovalue, "halfway between air and the tooth's dentine", boundaries_in(scan.grid)};
  }
  if (const BuiltinPhantom* phantom = phantom_of(options.scan))
    return {phantom->isovalue, "between air and all of its bone", boundaries_in(scan.grid)};
  if (scan.is_labels) return {isovalue_of_labels(scan.grid), "below all labels"};
  return suggest_isovalue(scan.grid, scan.in_hounsfield_units);
}

ChosenBone bone_of(Scan scan, double isovalue, const PieceChoice& pieces) {
  DensityGrid grid = scan.is_labels ? bone_of_labels(scan.grid, isovalue) : std::move(scan.grid);
  DiscardedPieces left_out;
  if (!pieces.keeps_all()) {
    left_out = discard_pieces(grid, isovalue, pieces);
    if (left_out.kept == 0)
      throw InputError(scan.name, fmt::format("has no piece of bone of {:g} mm^3", pieces.min_mm3));
  }
  return {Volume(std::move(grid), isovalue), left_out};
}

std::vector<RunSetting> scan_settings(const ScanOptions& options) {
  std::vector<RunSetting> settings;
  for (const Field<ScanOptions, std::string>& field : fields_of<ScanOptions, std::string>()) {
    if (const std::string text = field.get(options); !field.name.empty() && !text.empty())
      settings.push_back({field.name, text, ""});
  }
  for (const Field<ScanOptions>& field : fields_of<ScanOptions>()) {
    if (const double value = field.get(options); !field.name.empty() && value != field.get({}))
      settings.push_back({field.name, value, field.unit});
  }
  return settings;
}

ScanOptions scan_of(const RunDescription& run, ScanOptions given) {
  if (given.scan.empty() && run.scan_name != kBuiltinTooth) given.scan = run.scan_name;
  if (!given.isovalue) given.isovalue = run.isovalue;
  given.bone_fingerprint = run.scan_hash;
  for (const Field<ScanOptions, std::string>& field : fields_of<ScanOptions, std::string>()) {
    const std::string* recorded = find_setting<std::string>(run, field.name);
    if (recorded != nullptr && field.get(given).empty()) field.set(given, *recorded);
  }
  for (const Field<ScanOptions>& field : fields_of<ScanOptions>()) {
    const double* recorded = find_setting<double>(run, field.name);
    if (recorded != nullptr && field.get(given) == field.get({})) field.set(given, *recorded);
  }
  return given;
}

LabelsRead labels_of(const ScanOptions& options, const Scan& scan) {
  LabelFiles files = options.labels;
  if (files.map.empty() && scan.is_labels && !scan.labels.empty()) return labels_in(scan, files);
  if (files.map.empty() && scan.is_labels && is_label_file(options.scan)) files.map = options.scan;
  if (files.map.empty()) {
    if (!files.table.empty() || !files.no_go.empty())
      throw InputError(options.scan.empty() ? "the built-in tooth" : options.scan,
                       "has no labels; --labels names a label map");
    return {};
  }
  return read_labels(files, scan.grid.geometry(), options.read.max_memory_bytes);
}

LoadedBone read_bone(const ScanOptions& options) {
  limit_memory(options.scan.empty() ? "the built-in tooth" : options.scan, options.read.max_memory_bytes);
  Scan scan = [&] {
    const WorkProgress::Part reading(0.75);
    return open_scan(options);
  }();
  const WorkProgress::Part looking(1);
  SuggestedIsovalue isovalue =
      options.isovalue ? SuggestedIsovalue{*options.isovalue, "given"} : suggested_isovalue(options, scan);
  std::vector<std::string> warnings = std::move(scan.warnings);
  if (!options.isovalue && !is_builtin(options.scan)) {
    warnings.push_back(
        fmt::format("isovalue {:g} suggested, {}; --iso sets another", isovalue.value, isovalue.how));
  }
  const std::vector<std::string> of_isovalue = isovalue_warnings(scan.grid, isovalue.value);
  if (!is_within(scan.grid, isovalue.value)) throw InputError(scan.name, of_isovalue.front());
  // Phantoms reach the border of the scan on purpose.
  if (phantom_of(options.scan) == nullptr)
    warnings.insert(warnings.end(), of_isovalue.begin(), of_isovalue.end());
  for (std::string& warning : warnings) warning = scan.name + ": " + warning;
  LabelsRead labels = labels_of(options, scan);
  warnings.insert(warnings.end(), labels.warnings.begin(), labels.warnings.end());
  std::string name = scan.name;
  const bool in_hounsfield_units = scan.in_hounsfield_units;
  auto [bone, left_out] = bone_of(std::move(scan), isovalue.value, options.pieces);
  if (left_out.pieces > 0) {
    warnings.push_back(fmt::format(
        "{}: {} pieces of bone, {:g} mm^3 in total, were removed and {} kept", name, left_out.pieces,
        static_cast<double>(left_out.voxels) * bone.geometry().voxel_volume_mm3(), left_out.kept));
  }
  bone.set_labels(std::move(labels.map));
  return {std::move(bone), std::move(name), std::move(isovalue.how), std::move(warnings),
          in_hounsfield_units};
}

std::shared_ptr<const Volume> recorded_scan(const Recording& recording) {
  LoadedBone bone = read_bone(scan_of(recording.description));
  require_made_with(recording, bone.volume);
  return std::make_shared<const Volume>(std::move(bone.volume));
}

LoadedBone load_bone(const ScanOptions& options) {
  LoadedBone bone = read_bone(options);
  for (const std::string& warning : bone.warnings) warn(warning);
  return bone;
}

}  // namespace osteomill::app
