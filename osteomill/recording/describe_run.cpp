#include "osteomill/recording/describe_run.h"

#include <ctime>
#include <fstream>

#include <fmt/chrono.h>
#include <sys/utsname.h>

#include "osteomill/volume/label_map.h"

namespace osteomill {

namespace {

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

RunDescription describe_run(const RunFacts& facts, int sample_points) {
  RunDescription run;
  run.program_version = OSTEOMILL_VERSION;
  run.made = made_here_and_now();
  run.scan_name = facts.scan_name;
  run.dims = facts.geometry.dims;
  run.spacing_mm = facts.geometry.spacing_mm;
  run.origin_mm = facts.geometry.origin_mm;
  run.direction = facts.geometry.direction;
  run.scan_hash = facts.scan_hash;
  run.isovalue = facts.isovalue;
  run.seed = facts.seed;
  if (facts.labels) {
    run.labels = facts.labels->labels();
    run.label_map_hash = facts.labels->fingerprint();
  }
  run.settings.push_back({std::string(kCommandLineKey), facts.command_line, ""});
  set_session_settings(run, facts.session, sample_points);
  return run;
}

}  // namespace osteomill
