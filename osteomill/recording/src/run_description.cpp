#include "osteomill/recording/run_description.h"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <string_view>

#include <fmt/chrono.h>
#include <sys/utsname.h>

#include "osteomill/base/input_error.h"
#include "osteomill/milling/named_burrs.h"

namespace osteomill {

namespace {

constexpr std::string_view kAlgorithmPrefix = "algorithm.";

HapticSettings haptic_settings(const RunDescription& run) {
  HapticSettings haptics;
  for (const RunSetting& setting : run.settings) {
    const double* number = std::get_if<double>(&setting.value);
    if (number != nullptr && setting.key.starts_with(kAlgorithmPrefix))
      haptics.named.push_back({run.algorithm.name, setting.key.substr(kAlgorithmPrefix.size()), *number});
  }
  return haptics;
}

void set_algorithm(RunDescription& run, const MillingSetup& setup, int sample_points) {
  run.algorithm = setup.algorithm.id;
  const auto is_of_algorithm = [](const RunSetting& setting) {
    return setting.key == kSamplePointsKey || setting.key.starts_with(kAlgorithmPrefix);
  };
  // Replaces the previous algorithm's settings at the same position.
  const auto place = std::ranges::find_if(run.settings, is_of_algorithm) - run.settings.begin();
  std::erase_if(run.settings, is_of_algorithm);
  std::vector<RunSetting> settings{{std::string(kSamplePointsKey), static_cast<double>(sample_points), ""}};
  for (const SettingDescription& value : setting_values(setup.algorithm, setup.haptics))
    settings.push_back({std::string(kAlgorithmPrefix) + value.name, value.value, value.unit});
  run.settings.insert(run.settings.begin() + place, settings.begin(), settings.end());
}

// Returns the first model name in /proc/cpuinfo.
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "";
}

Origin current_origin() {
  utsname system{};
  ::uname(&system);
  Origin made;
  made.date_utc = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  made.host = system.nodename;
  made.system = fmt::format("{} {} {}", system.sysname, system.release, system.machine);
  made.processor = processor_name();
#ifdef __clang__
  made.compiler = __VERSION__;
#else
  made.compiler = "GCC " __VERSION__;
#endif
#ifdef __OPTIMIZE__
  made.build = "optimised";
#else
  made.build = "not optimised";
#endif
  return made;
}

}  // namespace

template <>
const std::vector<Field<SessionSettings>>& fields_of<SessionSettings>() {
  static const std::vector<Field<SessionSettings>> all = [] {
    auto fields = fields_within<SessionSettings>(&SessionSettings::setup, fields_of<MillingSetup>());
    fields.push_back(field<SessionSettings>(
        {"milling.surroundings_density", "", NumberRange::finite(),
         "Density of the material around the bone"},
        [](auto& s) -> auto& { return s.densities.surroundings; }));
    fields.push_back(field<SessionSettings>(
        {"milling.reference_density", "", NumberRange::finite(),
         "Density of bone whose removed volume counts fully"},
        [](auto& s) -> auto& { return s.densities.reference; }));
    return fields;
  }();
  return all;
}

void put_setting(RunDescription& run, const FieldDescription& field, double value) {
  const auto there = std::ranges::find(run.settings, field.name, &RunSetting::key);
  if (there == run.settings.end()) {
    run.settings.push_back({field.name, value, field.unit});
  } else {
    there->value = value;
  }
}

std::optional<double> read_setting(const RunDescription& run, const FieldDescription& field,
                                   const std::filesystem::path& path) {
  if (const double* number = find_setting<double>(run, field.name)) return *number;
  if (field.has(kMayBeAbsent)) return std::nullopt;
  throw InputError(path.string(), "has no setting '" + field.name + "', so its milling cannot be replayed");
}

void put_branch_point(RunDescription& run, const BranchPoint& from) {
  std::erase_if(run.settings, [](const RunSetting& setting) { return setting.key.starts_with("from."); });
  run.settings.push_back({"from.recording", from.recording, ""});
  run.settings.push_back({"from.ticks", static_cast<double>(from.ticks), ""});
  run.settings.push_back({"from.time", from.time_s, "s"});
}

std::optional<BranchPoint> branch_point(const RunDescription& run) {
  const auto* recording = find_setting<std::string>(run, "from.recording");
  const auto* ticks = find_setting<double>(run, "from.ticks");
  const auto* time_s = find_setting<double>(run, "from.time");
  if (recording == nullptr || ticks == nullptr || time_s == nullptr || !(*ticks >= 1 && *ticks < 1e15))
    return std::nullopt;
  return BranchPoint{*recording, static_cast<std::uint64_t>(*ticks), *time_s};
}

void set_session_settings(RunDescription& run, const SessionSettings& session, int sample_points) {
  run.tool = session.setup.tool;
  run.tick_period_s = session.setup.tick_s;
  set_algorithm(run, session.setup, sample_points);
  put_fields(run, session);
  std::erase_if(run.settings, [](const RunSetting& one) { return one.key == kBurrNameKey; });
  if (const NamedBurr* burr = find_burr(session.setup.tool, session.setup.burr))
    run.settings.push_back({std::string(kBurrNameKey), burr->name, ""});
}

SessionSettings session_settings(const RunDescription& run, const std::filesystem::path& path) {
  SessionSettings session;
  session.setup.tool = run.tool;
  session.setup.haptics = haptic_settings(run);
  session.setup.tick_s = run.tick_period_s;
  take_fields(run, path, session);
  return session;
}

RunDescription describe_run(const Volume& bone, const ScanIdentity& scan, const SessionSettings& session,
                            int sample_points, const std::string& command_line) {
  const GridGeometry& geometry = bone.geometry();
  RunDescription run;
  run.program_version = OSTEOMILL_VERSION;
  run.made = current_origin();
  run.scan_name = scan.name;
  run.scan_hash = scan.fingerprint;
  run.dims = geometry.dims;
  run.spacing_mm = geometry.spacing_mm;
  run.origin_mm = geometry.origin_mm;
  run.direction = geometry.direction;
  run.isovalue = bone.isovalue();
  if (const auto& labels = bone.labels()) {
    run.labels = labels->labels();
    run.label_map_hash = labels->fingerprint();
  }
  run.settings.push_back({std::string(kCommandLineKey), command_line, ""});
  if (const int guards = bone.no_go() ? count_guards(*bone.no_go()) : 0; guards > 0)
    run.settings.push_back({std::string(kGuardsKey), static_cast<double>(guards), ""});
  set_session_settings(run, session, sample_points);
  return run;
}

}  // namespace osteomill
