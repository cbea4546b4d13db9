#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/densities.h"
#include "osteomill/volume/volume.h"

namespace osteomill {

/// The key of the setting that says with how many sample points the algorithm works.
inline constexpr std::string_view kSamplePointsKey = "sample_points";

/// What a session goes by.
struct SessionSettings {
  MillingSetup setup;
  BoneDensities densities;
};

/// All of them in a run's description, in the place of those that it has. `sample_points` is how many the
/// algorithm works with.
void set_session_settings(RunDescription& run, const SessionSettings& session, int sample_points);

/// Read back, but for the algorithm: the run has its name, and whoever runs it knows which is meant. Throws
/// InputError, naming the recording's `path`, where a setting is missing.
SessionSettings session_settings(const RunDescription& run, const std::filesystem::path& path);

/// What any session is made of. Whoever runs it adds the settings of its own (a script, a hand) to what
/// `describe_run` makes of this.
struct RunFacts {
  std::string scan_name;
  /// Of the scan as it was read (fingerprint_of); a recording can be verified only against that one.
  std::uint64_t scan_hash = 0;
  /// Of which the grid's place, the isovalue and the labels are told.
  const Volume& bone;
  SessionSettings session;
  std::uint64_t seed = 0;
  /// How the program was called; may be empty.
  std::string command_line;
};

/// All that a recording says of such a session: program, scan, tool, every setting with its unit.
/// `sample_points` is how many the algorithm works with as it stands.
RunDescription describe_run(const RunFacts& facts, int sample_points);

}  // namespace osteomill
