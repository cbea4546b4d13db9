#pragma once

#include <filesystem>

#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_setup.h"
#include "osteomill/volume/densities.h"

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

}  // namespace osteomill
