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

/// One further setting of a run. `unit` is empty for a pure number, a choice or a name.
struct RunSetting {
  std::string key;
  std::variant<double, std::string> value;
  std::string unit;
  friend bool operator==(const RunSetting&, const RunSetting&) = default;
};

/// The key of the further setting that holds the command by which the run can be repeated (reports show it).
inline constexpr std::string_view kCommandLineKey = "command_line";

/// The key of the further setting that names, in words, the parts of its plan that a run did not reach; a
/// recording that reached all has none.
inline constexpr std::string_view kNotReachedKey = "not_reached";

/// The key of the further setting that names the comparison by which a recording was made: the same text in
/// all of its recordings, and in no others. Recordings that are not part of a comparison have none.
inline constexpr std::string_view kComparisonKey = "comparison";

/// The key of the number of structures off which the burr was held (WatchedStructure::guard_mm); a recording
/// without any has none.
inline constexpr std::string_view kGuardsKey = "exercise.guards";

/// The key of the burr's name (NamedBurr), for people; a recording of a burr without a name has none.
inline constexpr std::string_view kBurrNameKey = "burr_name";

/// The key of the stiffness of a simulated hand, in N/mm.
inline constexpr std::string_view kHandStiffnessKey = "hand.stiffness";
/// The key of the damping of a simulated hand, in N s/mm.
inline constexpr std::string_view kHandDampingKey = "hand.damping";

/// The place and time at which a recording was made. Holds nothing about a patient.
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

/// The description that a recording carries: enough to know what was run and to run it again.
struct RunDescription {
  std::string program_version;
  Origin made;
  /// The scan as the user named it, or what the built-in tooth is called.
  std::string scan_name;
  std::array<int, 3> dims{0, 0, 0};
  Vec3 spacing_mm = Vec3::Ones();
  /// The place of the grid (GridGeometry).
  Vec3 origin_mm = Vec3::Zero();
  Mat3 direction = Mat3::Identity();
  /// The fingerprints of the densities as they were read (fingerprint_of), against which alone a recording
  /// can be verified, and of the label map. 0 if not known, or if there is no map.
  std::uint64_t scan_hash = 0;
  std::uint64_t label_map_hash = 0;
  /// In the scan's own unit of density.
  double isovalue = 0;
  MillingTool tool;
  AlgorithmId algorithm;
  /// The part of a longer run that this is, in the words of the program that recorded it; empty for the
  /// whole.
  std::string phase;
  std::uint64_t seed = 0;
  double tick_period_s = 0.001;
  /// Everything else that was set, in the order in which people should read it; every key once.
  std::vector<RunSetting> settings;
  /// The labels of the bone's label map, by their places in it; empty if it has none. Every value once.
  std::vector<Label> labels;
};

/// The name that a recording has for a part of a run's description (visit_attributes()).
struct RunAttribute {
  std::string name;
  /// True if it is part of what was run, by which runs can be compared; false if it says when, where or which
  /// of them it was.
  bool is_setting = true;
};

/// Calls `visit(RunAttribute, value)` for all that a description has except its settings and labels, in the
/// order in which recordings have it.
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

/// Returns the value of a further setting; null if there is none of this key, or it has another type.
template <typename Value>
const Value* find_setting(const RunDescription& run, std::string_view key) {
  for (const RunSetting& setting : run.settings) {
    if (setting.key == key) return std::get_if<Value>(&setting.value);
  }
  return nullptr;
}

/// The tick of another recording from which a run goes on.
struct BranchPoint {
  /// The recording as the user named it.
  std::string recording;
  /// The number of its ticks until then, and the time of the last of them.
  std::uint64_t ticks = 0;
  double time_s = 0;
};
/// Puts it among the run's settings, in the place of another.
void put_branch_point(RunDescription& run, const BranchPoint& from);
/// Returns what the run says; nothing if it goes on from no other.
std::optional<BranchPoint> branch_point(const RunDescription& run);

/// The key of the number of sample points that the algorithm works with.
inline constexpr std::string_view kSamplePointsKey = "sample_points";

/// Puts a number among a run's settings, in the place of one of this name.
void put_setting(RunDescription& run, const FieldDescription& field, double value);
/// Returns a number of a run's settings; nothing if it has none and `field` may be absent. Throws InputError,
/// naming the recording's `path`, if it should have one.
std::optional<double> taken_setting(const RunDescription& run, const FieldDescription& field,
                                    const std::filesystem::path& path);

/// Puts every field that files have (FieldDescription::name) among a run's settings.
template <typename Struct>
void put_fields(RunDescription& run, const Struct& s) {
  for (const Field<Struct>& setting : fields_of<Struct>())
    if (!setting.name.empty()) put_setting(run, setting, setting.get(s));
}
/// Takes every field that files have back from a run's settings. Throws as `taken_setting`.
template <typename Struct>
void take_fields(const RunDescription& run, const std::filesystem::path& path, Struct& s) {
  for (const Field<Struct>& setting : fields_of<Struct>()) {
    if (setting.name.empty()) continue;
    if (const auto value = taken_setting(run, setting, path)) setting.set(s, *value);
  }
}

/// The settings that a session works by.
struct SessionSettings {
  MillingSetup setup;
  BoneDensities densities;
};
/// Returns every number of a session's settings, except those of its algorithm.
template <>
const std::vector<Field<SessionSettings>>& fields_of<SessionSettings>();

/// Puts all settings of a session into a run's description, in the place of those that it has.
/// `sample_points` is the number that the algorithm works with.
void set_session_settings(RunDescription& run, const SessionSettings& session, int sample_points);

/// Returns a session's settings as the run's description has them, without the algorithm: the run has only
/// its name, and the caller knows which one is meant. Throws InputError, naming the recording's `path`, if a
/// setting is missing.
SessionSettings session_settings(const RunDescription& run, const std::filesystem::path& path);

/// The scan of a bone as it was read, by which a recording can be verified.
struct ScanIdentity {
  /// The scan as the user named it (RunDescription::scan_name).
  std::string name;
  /// The fingerprint of its densities before any was milled (fingerprint_of). 0 if it is not known: then no
  /// recording of the run can be verified.
  std::uint64_t fingerprint;
};

/// Returns all that a recording says about a session on this bone, without what the caller alone knows and
/// may add: a seed, and settings of its own (a script, a hand). `sample_points` is the number that the
/// algorithm works with as it stands; `command_line`, how the program was called, may be empty.
RunDescription describe_run(const Volume& bone, const ScanIdentity& scan, const SessionSettings& session,
                            int sample_points, const std::string& command_line = {});

}  // namespace osteomill
