#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/bone_picture.h"
#include "app/scan_options.h"

#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_trial.h"

namespace osteomill::app {

/// What every algorithm of a comparison has in common.
struct TrialPlan {
  const LoadedBone& bone;
  BoneDensities densities;
  MillingEntry entry;
  TrialSettings settings;
  /// How the comparison was called, for whoever wants to repeat it.
  std::string command_line;
  /// Recordings carry the mode in their names, as a comparison of both modes needs.
  bool mode_in_names = false;
};

/// Runs one algorithm through both phases of section 8.2, shows progress, and writes one recording a phase
/// into `folder`, with pictures of the bone before and after in the first, or a setting that says why there
/// are none. Returns their paths.
std::vector<std::filesystem::path> record_trial(const TrialPlan& plan, AlgorithmId algorithm,
                                                const EntryPictures& pictures,
                                                const std::filesystem::path& folder);

}  // namespace osteomill::app
