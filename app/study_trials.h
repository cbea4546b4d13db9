#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "osteomill/study/run_trials.h"
#include "osteomill/study/study_design.h"

#include "app/scan_options.h"
#include "app/trial_options.h"

namespace osteomill::app {

/// The settings of a trial: the options of `compare`, and those that only a study has.
struct TrialSpec {
  ScanOptions scan;
  TrialOptions trial;
  /// The voxel size of the built-in tooth.
  double voxel_mm = 0.125;
  double rate_hz = 1000;
  double device_damping_Ns_per_mm = 0.005;
  double grip = 1;
  bool draw_hand = false;
};

/// Returns the numbers and the texts of a trial, each under its option.
const std::vector<Field<TrialSpec>>& numbers_of_a_trial();
const std::vector<Field<TrialSpec, std::string>>& texts_of_a_trial();

/// Returns the settings that a study gives a trial. Throws std::invalid_argument, or a CLI::Error, if a value
/// is out of its range.
TrialSpec trial_spec(const StudySettings& settings);

/// Returns which bone a trial has: its fields that have kBoneField, in words. Trials whose words are the same
/// share a bone.
std::string bone_text(const TrialSpec& asked);

/// A study as its file describes it, and its trials, each made of what is set of it. Opens every
/// bone once.
class StudyTrials {
 public:
  /// Scans are sought from the folder `scans_from`. Throws as read_study_file does.
  StudyTrials(const std::string& file, std::filesystem::path scans_from);
  StudyTrials(const StudyTrials&) = delete;
  StudyTrials& operator=(const StudyTrials&) = delete;

  const std::string& file() const { return file_; }
  const StudyDesign& design() const { return design_; }

  /// Sets the fingerprints that bones must have from then on, by their words (bone_text).
  void expect(const std::vector<std::pair<std::string, std::uint64_t>>& bones) {
    fingerprints_ = {bones.begin(), bones.end()};
  }
  const std::map<std::string, std::uint64_t>& fingerprints() const { return fingerprints_; }

  /// Returns trials that follow each other. They refer to this object's bones, until the next call. Throws
  /// InputError, naming the file and the trial, if a setting is out of its range or does not go with the
  /// others, or if its scan is at fault or has changed.
  std::vector<TrialPlan> make(std::size_t first, std::size_t count);
  /// Returns a line on the poor settings of trials that were made (setting_warnings); empty if there are
  /// none.
  std::string settings_warning() const;

 private:
  struct Bone {
    Volume volume;
    std::string name;
    BoneDensities densities;
    // By tool, place and direction.
    std::map<std::string, MillingEntry> entries;
  };

  TrialPlan trial_of(const StudySettings& settings);
  Bone& bone_of(const TrialSpec& asked);
  const Volume& wall_of(const MillingTool& tool);

  std::string file_;
  std::filesystem::path scans_from_;
  StudyDesign design_;
  // By the fields that make a bone (bone_text); walls by the tool. A bone's fingerprint stays when the bone
  // itself is let go.
  std::map<std::string, std::unique_ptr<Bone>> bones_;
  std::map<std::string, Volume> walls_;
  std::map<std::string, std::uint64_t> fingerprints_;
  std::set<std::size_t> warned_trials_;
  std::string first_warning_;
};

}  // namespace osteomill::app
