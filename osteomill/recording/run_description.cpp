#include "osteomill/recording/run_description.h"

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <string_view>

#include <fmt/chrono.h>
#include <sys/utsname.h>

#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

constexpr std::string_view kAlgorithmPrefix = "algorithm.";

struct Entry {
  const char* key;
  const char* unit;
  double (*get)(const SessionSettings&);
  void (*set)(SessionSettings&, double);
};

#define OSTEOMILL_SETTING(field)                              \
  [](const SessionSettings& s) -> double { return s.field; }, \
      [](SessionSettings& s, double value) { s.field = value; }

#define OSTEOMILL_SWITCH(field)                                       \
  [](const SessionSettings& s) -> double { return s.field ? 1 : 0; }, \
      [](SessionSettings& s, double value) { s.field = value != 0; }

constexpr std::array kEntries{
    Entry{"milling.removal_rate", "mm^3/(N s)",
          [](const SessionSettings& s) { return milling_settings(s.setup).removal_rate_mm3_per_Ns; },
          [](SessionSettings& s, double value) { s.setup.removal_rate_mm3_per_Ns = value; }},
    Entry{"milling.reaction_share", "",
          [](const SessionSettings& s) { return milling_settings(s.setup).reaction_share; },
          [](SessionSettings& s, double value) {
            s.setup.cutting_reaction = value != 0;
            if (value != 0) s.setup.cutting.tangential_share = value;
          }},
    Entry{"milling.surroundings_density", "", OSTEOMILL_SETTING(densities.surroundings)},
    Entry{"milling.reference_density", "", OSTEOMILL_SETTING(densities.reference)},
    Entry{"limit.force", "N", OSTEOMILL_SETTING(setup.guard.limits.force_N)},
    Entry{"limit.torque", "N mm", OSTEOMILL_SETTING(setup.guard.limits.torque_Nmm)},
    Entry{"vibration", "", OSTEOMILL_SWITCH(setup.vibration.on)},
    Entry{"vibration.spindle_speed", "rpm", OSTEOMILL_SETTING(setup.cutting.spindle_speed_rpm)},
    Entry{"vibration.force_share", "", OSTEOMILL_SETTING(setup.vibration.force_share)},
    Entry{"vibration.max_force", "N", OSTEOMILL_SETTING(setup.vibration.max_N)},
    Entry{"guard.max_force_rate", "N/s", OSTEOMILL_SETTING(setup.guard.rates.force_N_s)},
    Entry{"guard.max_torque_rate", "N mm/s", OSTEOMILL_SETTING(setup.guard.rates.torque_Nmm_s)},
    Entry{"guard.blend", "s", OSTEOMILL_SETTING(setup.guard.blend_s)},
    Entry{"guard.max_move", "mm", OSTEOMILL_SETTING(setup.guard.max_move_mm)},
    Entry{"guard.max_turn", "rad", OSTEOMILL_SETTING(setup.guard.max_turn_rad)},
    Entry{"guard.max_tick", "s", OSTEOMILL_SETTING(setup.guard.max_tick_s)},
    Entry{"passivity_controller", "", OSTEOMILL_SWITCH(setup.guard.passivity_controller)},
};

#undef OSTEOMILL_SWITCH
#undef OSTEOMILL_SETTING

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
  // In the place of those of the algorithm before.
  const auto place = std::ranges::find_if(run.settings, is_of_algorithm) - run.settings.begin();
  std::erase_if(run.settings, is_of_algorithm);
  std::vector<RunSetting> settings{{std::string(kSamplePointsKey), static_cast<double>(sample_points), ""}};
  for (const SettingValue& value : setting_values(setup.algorithm, setup.haptics))
    settings.push_back({std::string(kAlgorithmPrefix) + value.name, value.value, value.unit});
  run.settings.insert(run.settings.begin() + place, settings.begin(), settings.end());
}

// The first line of /proc/cpuinfo that names it.
std::string processor_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);) {
    const std::size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "";
}

Origin made_here_and_now() {
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

void set_session_settings(RunDescription& run, const SessionSettings& session, int sample_points) {
  run.tool = session.setup.tool;
  run.tick_period_s = session.setup.tick_s;
  set_algorithm(run, session.setup, sample_points);
  for (const Entry& entry : kEntries) {
    const auto there = std::ranges::find(run.settings, entry.key, &RunSetting::key);
    if (there == run.settings.end()) {
      run.settings.push_back({entry.key, entry.get(session), entry.unit});
    } else {
      there->value = entry.get(session);
    }
  }
}

SessionSettings session_settings(const RunDescription& run, const std::filesystem::path& path) {
  SessionSettings session;
  session.setup.tool = run.tool;
  session.setup.haptics = haptic_settings(run);
  session.setup.tick_s = run.tick_period_s;
  for (const Entry& entry : kEntries) {
    const double* number = find_setting<double>(run, entry.key);
    if (number == nullptr) {
      throw InputError(path.string(),
                       std::string("has no setting '") + entry.key + "', so its milling cannot be repeated");
    }
    entry.set(session, *number);
  }
  return session;
}

RunDescription describe_run(const Volume& bone, const SessionSettings& session, int sample_points,
                            const std::string& command_line) {
  const GridGeometry& geometry = bone.geometry();
  RunDescription run;
  run.program_version = OSTEOMILL_VERSION;
  run.made = made_here_and_now();
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
  set_session_settings(run, session, sample_points);
  return run;
}

}  // namespace osteomill
