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

/// The options that choose the bone to work on.
struct ScanOptions {
  /// The scan: a path, or "builtin:" and a name; empty for the built-in tooth.
  std::string scan;
  /// The isovalue; if not given, the built-in tooth's own, or one suggested from the scan's values.
  std::optional<double> isovalue;
  ReadOptions read;
  /// A label map beside the scan, and which of its labels are no-go.
  LabelFiles labels{};
  /// Whether the scan holds labels in the place of densities. If not given, the file's header or its values
  /// decide; with an isovalue given it holds none.
  std::optional<bool> as_labels{};
  /// The pieces of bone that are kept.
  PieceChoice pieces{};
  /// The fingerprint (fingerprint_of) of the bone that an earlier run made of this scan, 0 for none. It tells
  /// whether the scan was then taken for densities or for labels.
  std::uint64_t bone_fingerprint = 0;
  /// The refinement of the built-in tooth (builtin_tooth).
  double refinement = 1;
};

/// Flags of the fields of a ScanOptions, and of structs that have one. kSourceField: how the scan is read.
/// kBoneChoiceField: which part of it is bone. kNoGoField: what the burr must not touch. kBoneField: another
/// value makes another bone.
inline constexpr unsigned kSourceField = 1u << 8, kBoneChoiceField = 1u << 9, kNoGoField = 1u << 10,
                          kBoneField = 1u << 11;

}  // namespace osteomill::app

namespace osteomill {

/// Return the numbers and the texts of a scan's options, without the scan itself.
template <>
const std::vector<Field<app::ScanOptions>>& fields_of<app::ScanOptions>();
template <>
const std::vector<Field<app::ScanOptions, std::string>>& fields_of<app::ScanOptions, std::string>();

}  // namespace osteomill

namespace osteomill::app {

/// The bone's name if no scan is named.
inline constexpr const char* kBuiltinTooth = "built-in tooth";

/// Returns whether this is a scan that the program makes: "builtin:" and a name, or empty for the tooth.
bool is_builtin(const std::string& scan);

/// Adds SCAN and what it takes to read it: --series, --as, --max-memory.
/// `without_one` says in the help which scan is taken if none is named.
void add_scan_source(CLI::App& command, ScanOptions& options,
                     const std::string& without_one = "the built-in tooth");

/// Adds the options for which part of it is bone and for its labels: --iso, --keep-largest, --min-piece,
/// --labels, --label-table.
void add_bone_options(CLI::App& command, ScanOptions& options);

/// All of these and --no-go.
void add_scan_options(CLI::App& command, ScanOptions& options,
                      const std::string& without_one = "the built-in tooth");

/// Reads the scan, or makes the built-in tooth. If it is taken for labels, the first of its warnings says so.
/// Throws InputError as `read_scan` does.
Scan open_scan(const ScanOptions& options);

/// Returns the isovalue for this scan if the user has given none.
SuggestedIsovalue suggested_isovalue(const ScanOptions& options, const Scan& scan);

/// A bone, and what was left out of it.
struct ChosenBone {
  Volume volume;
  PiecesLeftOut left_out;
};
/// Makes the bone of a scan: its densities with the isovalue, or, if it holds labels, all voxels labelled
/// above the isovalue, at one density; without the pieces that are not chosen. Throws InputError if none is
/// left.
ChosenBone bone_of(Scan scan, double isovalue, const PieceChoice& pieces);

/// Reads the labels of a scan, if it has any: those of the label map that is named, or, if the scan is itself
/// a label map, its own. Their warnings name the file.
/// Throws InputError as `read_labels` does.
LabelsRead labels_of(const ScanOptions& options, const Scan& scan);

/// A bone ready to be milled, with its labels.
struct LoadedBone {
  Volume volume;
  /// The scan as the user named it, or kBuiltinTooth.
  std::string name;
  /// The source of its isovalue: "given", or how it was suggested; half a sentence.
  std::string isovalue_from;
  /// Warnings about the scan and the isovalue, each naming the scan.
  std::vector<std::string> warnings;
  bool in_hounsfield_units = false;
};

/// Returns the settings of a run that say how its scan was read, from which `scan_of` reads it again. The
/// scan's name and the isovalue are attributes of every recording.
std::vector<RunSetting> scan_settings(const ScanOptions& options);
/// Returns the options that read the scan of a run again. Those that are set in `given` go before the
/// recorded.
ScanOptions scan_of(const RunDescription& run, ScanOptions given = {});

/// Reads the bone with its labels. Throws InputError if the scan or the isovalue is at fault.
LoadedBone read_bone(const ScanOptions& options);

/// Reads the scan of a recording again, for reports. Throws InputError as `read_bone` and
/// `require_made_with`.
std::shared_ptr<const Volume> recorded_scan(const Recording& recording);

/// Reads the bone as `read_bone` does and prints its warnings to standard error, one line each.
LoadedBone load_bone(const ScanOptions& options);

}  // namespace osteomill::app
