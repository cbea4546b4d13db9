#pragma once

#include <filesystem>

#include "osteomill/haptics/algorithm_description.h"
#include "osteomill/milling/burr_mill.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/vibration.h"
#include "osteomill/session/wrench_guard.h"
#include "osteomill/volume/densities.h"

namespace osteomill {

/// What a session goes by, beside its tool and its algorithm.
struct SessionSettings {
  BoneDensities densities;
  MillingSettings milling;
  VibrationSettings vibration;
  GuardSettings guard;
};

/// All of them as settings of a run, in the place of those that it has.
void set_session_settings(RunDescription& run, const SessionSettings& session);

/// Read back. Throws InputError, naming the recording's `path`, where one is missing that every recording has
/// had; others are then as in sessions of that time.
SessionSettings session_settings(const RunDescription& run, const std::filesystem::path& path);

/// How the algorithm of a run was set, and the other way round: another algorithm in a run's description.
HapticSettings haptic_settings(const RunDescription& run);
void set_algorithm(RunDescription& run, const AlgorithmDescription& algorithm, const HapticSettings& haptics,
                   int sample_points);

}  // namespace osteomill
