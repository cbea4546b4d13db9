#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/base/pose.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/bone_densities.h"
#include "osteomill/volume/label_map.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// Further setting of a run. `unit` is empty for a dimensionless number, a choice or a name.
struct RunSetting {
  std::string key;
  std::variant<double, std::string> value;
  std::string unit;
  friend bool operator==(const RunSetting&, const RunSetting&) = default;
};

/// Key of the further setting with the command line that repeats the run (shown in reports).
inline constexpr std::string_view kCommandLineKey = "command_line";

/// Key of the further setting that describes the parts of its plan that a run did not reach; absent if it
/// reached all.
inline constexpr std::string_view kNotReachedKey = "not_reached";

/// Key of the further setting that identifies the comparison a recording belongs to: the same text in all of
/// its recordings and in no others. Absent if the recording is not part of a comparison.
inline constexpr std::string_view kComparisonKey = "comparison";

/// Key of the number of guarded structures (WatchedStructure::guard_mm); absent if there were none.
inline constexpr std::string_view kGuardsKey = "exercise.guards";

/// Key of the burr's display name (NamedBurr); absent if the burr has none.
inline constexpr std::string_view kBurrNameKey = "burr_name";

/// Key of the stiffness of a simulated hand, N/mm.
inline constexpr std::string_view kHandStiffnessKey = "hand.stiffness";
/// Key of the damping of a simulated hand, N s/mm.
inline constexpr std::string_view kHandDampingKey = "hand.damping";

/// Time, machine and build with which a recording was made. Contains no patient data.
struct Origin {
  /// "2026-11-22T13:45:00Z".
  std::string date_utc;
  std::string host;
  std::string system;
  std::string processor;
  std::string compiler;
  /// "optimised" or "not optimised".
  std::string build;
  friend bool operator==(const Origin&, const Origin&) = default;
};

/// Description stored in a recording, sufficient to identify the run and to repeat it.
struct RunDescription {
  std::string program_version;
  Origin made;
  /// Scan as the user named it, or the name of the built-in scan.
  std::string scan_name;
  std::array<int, 3> dims{0, 0, 0};
  Vec3 spacing_mm = Vec3::Ones();
  /// Position of the grid (GridGeometry).
  Vec3 origin_mm = Vec3::Zero();
  Mat3 direction = Mat3::Identity();
  /// Fingerprints of the densities as read (fingerprint_of), required to verify the recording, and of the
  /// label map. 0 if unknown, or if there is no map.
  std::uint64_t scan_hash = 0;
  std::uint64_t label_map_hash = 0;
  /// In the scan's density unit.
  double isovalue = 0;
  MillingTool tool;
  AlgorithmId algorithm;
  /// Name, given by the recording program, of the part of a longer run; empty for a whole run.
  std::string phase;
  std::uint64_t seed = 0;
  double tick_period_s = 0.001;
  /// All other settings in reading order; keys are unique.
  std::vector<RunSetting> settings;
  /// Labels of the bone's label map in its order; empty if it has none. Values are unique.
  std::vector<Label> labels;
};

/// Name of a member of RunDescription in recordings (visit_attributes()).
struct RunAttribute {
  std::string name;
  /// True if it determines the run, so that it serves to compare runs; false if it identifies when, where or
  /// which run it was.
  bool is_setting = true;
};

/// Calls `visit(RunAttribute, value)` for every member of a description except settings and labels, in the
/// order of recordings.
template <typename Run, typename Visit>
void visit_attributes(Run& run, const Visit& visit) {
  visit(RunAttribute{"program_version"}, run.program_version);
  visit(RunAttribute{"date_utc", false}, run.made.date_utc);
  visit(RunAttribute{"host", false}, run.made.host);
  visit(RunAttribute{"system", false}, run.made.system);
  visit(RunAttribute{"processor", false}, run.made.processor);
  visit(RunAttribute{"compiler", false}, run.made.compiler);
  visit(RunAttribute{"build", false}, run.made.build);
  visit(RunAttribute{"scan_name"}, run.scan_name);
  visit(RunAttribute{"dims"}, run.dims);
  visit(RunAttribute{"spacing_mm"}, run.spacing_mm);
  visit(RunAttribute{"origin_mm"}, run.origin_mm);
  visit(RunAttribute{"axis_i"}, run.direction.col(0));
  visit(RunAttribute{"axis_j"}, run.direction.col(1));
  visit(RunAttribute{"axis_k"}, run.direction.col(2));
  visit(RunAttribute{"scan_hash"}, run.scan_hash);
  visit(RunAttribute{"label_map_hash"}, run.label_map_hash);
  visit(RunAttribute{"isovalue"}, run.isovalue);
  visit(RunAttribute{"burr_radius_mm"}, run.tool.burr_radius_mm);
  visit(RunAttribute{"shaft_radius_mm"}, run.tool.shaft_radius_mm);
  visit(RunAttribute{"shaft_length_mm"}, run.tool.shaft_length_mm);
  visit(RunAttribute{"algorithm", false}, run.algorithm.name);
  visit(RunAttribute{"algorithm_label", false}, run.algorithm.label);
  visit(RunAttribute{"algorithm_colour", false}, run.algorithm.colour);
  visit(RunAttribute{"phase", false}, run.phase);
  visit(RunAttribute{"seed"}, run.seed);
  visit(RunAttribute{"tick_period_s"}, run.tick_period_s);
}

/// Returns the value of a further setting; null if the key is missing or the value has another type.
template <typename Value>
const Value* find_setting(const RunDescription& run, std::string_view key) {
  for (const RunSetting& setting : run.settings) {
    if (setting.key == key) return std::get_if<Value>(&setting.value);
  }
  return nullptr;
}

/// Tick of another recording that a run continues from.
struct BranchPoint {
  /// Recording as the user named it.
  std::string recording;
  /// Number of its ticks up to that point, and the time of the last of them.
  std::uint64_t ticks = 0;
  double time_s = 0;
};
/// Stores the branch point in the run's settings, replacing an existing one.
void put_branch_point(RunDescription& run, const BranchPoint& from);
/// Returns the run's branch point; nullopt if it does not continue another recording.
std::optional<BranchPoint> branch_point(const RunDescription& run);

/// Key of the number of sample points used by the algorithm.
inline constexpr std::string_view kSamplePointsKey = "sample_points";

/// Stores a number in a run's settings, replacing an existing one of the same name.
void put_setting(RunDescription& run, const FieldDescription& field, double value);
/// Returns a number from a run's settings; nullopt if it is missing and `field` may be absent. Throws
/// InputError, naming the recording's `path`, if a required one is missing.
std::optional<double> read_setting(const RunDescription& run, const FieldDescription& field,
                                   const std::filesystem::path& path);

/// Stores every field that has a name in files (FieldDescription::name) in a run's settings.
template <typename Struct>
void put_fields(RunDescription& run, const Struct& s) {
  for (const Field<Struct>& setting : fields_of<Struct>())
    if (!setting.name.empty()) put_setting(run, setting, setting.get(s));
}
/// Reads every field that has a name in files from a run's settings. Throws as `read_setting`.
template <typename Struct>
void take_fields(const RunDescription& run, const std::filesystem::path& path, Struct& s) {
  for (const Field<Struct>& setting : fields_of<Struct>()) {
    if (setting.name.empty()) continue;
    if (const auto value = read_setting(run, setting, path)) setting.set(s, *value);
  }
}

/// Settings of a session.
struct SessionSettings {
  MillingSetup setup;
  BoneDensities densities;
};
/// Returns the fields of all numeric session settings except those of the algorithm.
template <>
const std::vector<Field<SessionSettings>>& fields_of<SessionSettings>();

/// Stores all settings of a session in a run's description, replacing existing ones. `sample_points` is the
/// number of points the algorithm uses.
void set_session_settings(RunDescription& run, const SessionSettings& session, int sample_points);

/// Returns the session settings in a run's description, without `setup.algorithm`: the run has only its name,
/// which the caller must resolve. Throws InputError, naming the recording's `path`, if a setting is missing.
SessionSettings session_settings(const RunDescription& run, const std::filesystem::path& path);

/// Identifies the scan as read, against which a recording can be verified.
struct ScanIdentity {
  /// Scan as the user named it (RunDescription::scan_name).
  std::string name;
  /// Fingerprint of its unmilled densities (fingerprint_of). If it is 0 (unknown), recordings of the run
  /// cannot be verified.
  std::uint64_t fingerprint;
};

/// Returns the description of a session on this bone. The caller may add a seed and settings of its own (a
/// script, a hand). `sample_points` is the number of points the algorithm currently uses; `command_line` is
/// the program's command line and may be empty.
RunDescription describe_run(const Volume& bone, const ScanIdentity& scan, const SessionSettings& session,
                            int sample_points, const std::string& command_line = {});

}  // namespace osteomill
