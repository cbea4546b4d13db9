#include "app/scan_options.h"

#include <algorithm>
#include <utility>

#include "app/memory_limit.h"
#include "app/positive_number.h"
#include "app/progress.h"
#include <fmt/core.h>

#include "osteomill/ct/read_scan.h"
#include "osteomill/files/input_error.h"
#include "osteomill/numbers/work_progress.h"
#include "osteomill/volume/builtin_tooth.h"
#include "osteomill/volume/isovalue.h"

namespace osteomill::app {

void add_label_options(CLI::App& command, LabelFiles& labels) {
  command
      .add_option("--labels", labels.map,
                  "A label map of the scan (NRRD, .seg.nrrd, NIfTI, MetaImage), on any grid")
      ->check(not_empty())
      ->type_name("FILE");
  command
      .add_option("--label-table", labels.table, "Names and colours of labels: a colour table of 3D Slicer's")
      ->check(not_empty())
      ->type_name("FILE");
}

void add_scan_source(CLI::App& command, ScanOptions& options) {
  command.add_option("scan", options.scan, kScanText)->check(not_empty());
  command
      .add_option(
          "--series", options.read.series,
          "Which DICOM series, where there are several: its number in what info lists, or the beginning "
          "of its UID; else the largest CT")
      ->check(not_empty())
      ->type_name("SERIES");
  command
      .add_option_function<double>(
          "--max-memory",
          [&bytes = options.read.max_memory_bytes](double gigabytes) {
            bytes = static_cast<std::uint64_t>(gigabytes * 1e9);
          },
          "Refuse a scan that takes more, with all that is made of it or unpacked; else what the machine has")
      ->check(CLI::Range(1e-3, 1e6))
      ->type_name("GB");
}

void add_scan_options(CLI::App& command, ScanOptions& options) {
  command.option_defaults()->group("Scan");
  add_scan_source(command, options);
  command.add_option("--iso", options.isovalue, "Isovalue: bone where the density is greater")
      ->check(not_empty())
      ->type_name("DENSITY");
  add_label_options(command, options.labels);
  const auto take = [&labels = options.labels](const std::vector<std::string>& said) { labels.no_go = said; };
  command
      .add_option_function<std::vector<std::string>>("--no-go", take,
                                                     "Labels that the burr must not touch, by name or value")
      ->delimiter(',')
      ->type_name("LABEL,...");
}

Scan open_scan(const ScanOptions& options) {
  if (!options.scan.empty()) return read_scan(options.scan, options.read);
  return {builtin_tooth(), "built-in tooth", "made up", {}};
}

SuggestedIsovalue suggested_isovalue(const ScanOptions& options, const Scan& scan) {
  if (options.scan.empty()) return {kBuiltinToothIsovalue, "halfway between air and the tooth's dentine"};
  return suggest_isovalue(scan.grid, scan.in_hounsfield_units);
}

SuggestedIsovalue chosen_isovalue(const ScanOptions& options, const Scan& scan) {
  if (options.isovalue) return {*options.isovalue, "given"};
  return suggested_isovalue(options, scan);
}

Volume bone_of(DensityGrid grid, double isovalue) {
  if (isovalue_of_labels(grid)) grid = bone_of_labels(grid, isovalue);
  return Volume(std::move(grid), isovalue);
}

LabelsRead labels_of(const ScanOptions& options, const DensityGrid& grid) {
  LabelFiles files = options.labels;
  const bool own = files.map.empty() && is_label_file(options.scan) && isovalue_of_labels(grid);
  if (own) files.map = options.scan;
  if (files.map.empty()) {
    if (!files.table.empty() || !files.no_go.empty())
      throw InputError(options.scan.empty() ? "the built-in tooth" : options.scan,
                       "has no labels; --labels gives them");
    return {};
  }
  LabelsRead read = read_labels(files, grid.geometry(), options.read.max_memory_bytes);
  if (own) {
    read.warnings.push_back(files.map.string() +
                            ": is a label map, not a scan: what it labels is taken for bone of one density");
  }
  return read;
}

LoadedBone read_bone(const ScanOptions& options) {
  limit_memory(options.scan.empty() ? "the built-in tooth" : options.scan, options.read.max_memory_bytes);
  Scan scan = [&] {
    const WorkProgress::Part reading(0.75);
    return open_scan(options);
  }();
  const WorkProgress::Part looking(1);
  SuggestedIsovalue isovalue = chosen_isovalue(options, scan);
  std::vector<std::string> warnings = std::move(scan.warnings);
  if (!options.isovalue && !options.scan.empty()) {
    warnings.push_back(
        fmt::format("isovalue {:g} suggested, {}; --iso sets another", isovalue.value, isovalue.how));
  }
  const std::vector<std::string> of_isovalue = isovalue_warnings(scan.grid, isovalue.value);
  if (!is_within(scan.grid, isovalue.value)) throw InputError(scan.name, of_isovalue.front());
  warnings.insert(warnings.end(), of_isovalue.begin(), of_isovalue.end());
  for (std::string& warning : warnings) warning = scan.name + ": " + warning;
  LabelsRead labels = labels_of(options, scan.grid);
  warnings.insert(warnings.end(), labels.warnings.begin(), labels.warnings.end());
  Volume bone = bone_of(std::move(scan.grid), isovalue.value);
  bone.set_labels(std::move(labels.map));
  return {std::move(bone), scan.name, std::move(isovalue.how), std::move(warnings), scan.in_hounsfield_units};
}

LoadedBone load_bone(const ScanOptions& options) {
  LoadedBone bone = read_bone(options);
  for (const std::string& warning : bone.warnings) warn(warning);
  return bone;
}

}  // namespace osteomill::app
