#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/base/field.h"
#include "osteomill/ct/read_labels.h"
#include "osteomill/ct/read_scan.h"
#include "osteomill/recording/recording.h"
#include "osteomill/volume/bone_pieces.h"
#include "osteomill/volume/isovalue.h"
#include "osteomill/volume/volume.h"

namespace osteomill::app {

/// The options that select the bone.
struct ScanOptions {
  /// The scan: a path, or "builtin:" and a name; empty for the built-in tooth.
  std::string scan;
  /// The isovalue; if empty, the built-in tooth's own, or one suggested from the scan's values.
  std::optional<double> isovalue;
  ReadOptions read;
  /// The label map of the scan, and its no-go labels.
  LabelFiles labels{};
  /// Whether the scan holds labels instead of densities. If empty, the file's header or values decide, or it
  /// holds densities if an isovalue is given.
  std::optional<bool> as_labels{};
  /// The pieces of bone to keep.
  PieceChoice pieces{};
  /// Fingerprint (fingerprint_of) of the bone that an earlier run made of this scan, or 0. It identifies
  /// whether that run read densities or labels.
  std::uint64_t bone_fingerprint = 0;
  /// The refinement of the built-in tooth (builtin_tooth).
  double refinement = 1;
};

/// Flags of the fields of ScanOptions and of structs that contain it. kSourceField: reading of the scan.
/// kBoneChoiceField: selection of bone in it. kNoGoField: structures the burr must not touch. kBoneField: the
/// value affects the bone.
inline constexpr unsigned kSourceField = 1u << 8, kBoneChoiceField = 1u << 9, kNoGoField = 1u << 10,
                          kBoneField = 1u << 11;

}  // namespace osteomill::app

namespace osteomill {

/// Return the numeric and the text fields of ScanOptions, except the scan itself.
template <>
const std::vector<Field<app::ScanOptions>>& fields_of<app::ScanOptions>();
template <>
const std::vector<Field<app::ScanOptions, std::string>>& fields_of<app::ScanOptions, std::string>();

}  // namespace osteomill

namespace osteomill::app {

/// The name of the bone if no scan is given.
inline constexpr const char* kBuiltinTooth = "built-in tooth";

/// Returns whether the program generates this scan: "builtin:" and a name, or empty for the tooth.
bool is_builtin(const std::string& scan);

/// Adds SCAN, --series, --spacing, --as and --max-memory. `default_scan` is the default scan in the help
/// text.
void add_scan_source(CLI::App& command, ScanOptions& options,
                     const std::string& default_scan = "the built-in tooth");

/// Adds the options that select bone, and the labels: --iso, --keep-largest, --min-piece, --labels,
/// --label-table.
void add_bone_options(CLI::App& command, ScanOptions& options);

/// Adds the options of add_scan_source and add_bone_options, and --no-go.
void add_scan_options(CLI::App& command, ScanOptions& options,
                      const std::string& default_scan = "the built-in tooth");

/// Reads the scan, or generates a built-in one. Its first warning reports if it is read as labels. Throws
/// InputError as `read_scan` does.
Scan open_scan(const ScanOptions& options);

/// Returns the isovalue to use if the user gives none.
SuggestedIsovalue suggested_isovalue(const ScanOptions& options, const Scan& scan);

/// A bone, and the pieces removed from it.
struct ChosenBone {
  Volume volume;
  DiscardedPieces left_out;
};
/// Makes the bone of a scan: its densities with the isovalue, or for a label map, all voxels with labels
/// above the isovalue, at one density. Removes the pieces that `pieces` excludes; throws InputError if none
/// is left.
ChosenBone bone_of(Scan scan, double isovalue, const PieceChoice& pieces);

/// Reads the labels of a scan, if it has any: from the given label map, or the scan's own if it is one
/// itself. The warnings name the file. Throws InputError as `read_labels` does.
LabelsRead labels_of(const ScanOptions& options, const Scan& scan);

/// A bone ready to be milled, with its labels.
struct LoadedBone {
  Volume volume;
  /// The scan as the user named it, or kBuiltinTooth.
  std::string name;
  /// The source of the isovalue: "given", or the phrase that explains the suggestion.
  std::string isovalue_from;
  /// Warnings about the scan and the isovalue, each naming the scan.
  std::vector<std::string> warnings;
  bool in_hounsfield_units = false;
};

/// Returns the settings to record so that `scan_of` can read the scan again. The scan's name and the isovalue
/// are attributes of every recording and not included.
std::vector<RunSetting> scan_settings(const ScanOptions& options);
/// Returns the options to read the scan of a run again. Those set in `given` take precedence over the
/// recorded ones.
ScanOptions scan_of(const RunDescription& run, ScanOptions given = {});

/// Reads the bone with its labels. Throws InputError if the scan or the isovalue is invalid.
LoadedBone read_bone(const ScanOptions& options);

/// Reads the scan of a recording again, for reports. Throws InputError as `read_bone` and `require_made_with`
/// do.
std::shared_ptr<const Volume> recorded_scan(const Recording& recording);

/// Reads the bone as `read_bone` does and prints its warnings to standard error, one line each.
LoadedBone load_bone(const ScanOptions& options);

}  // namespace osteomill::app
