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

/// The settings of a trial: the options of `compare`, and options that only studies have.
struct TrialSpec {
  ScanOptions scan;
  TrialOptions trial;
  /// Voxel size of the built-in tooth.
  double voxel_mm = 0.125;
  double rate_hz = 1000;
  double device_damping_Ns_per_mm = 0.005;
  double grip = 1;
  bool draw_hand = false;
};

/// Return the numeric and the text fields of a trial that have an option.
const std::vector<Field<TrialSpec>>& trial_number_fields();
const std::vector<Field<TrialSpec, std::string>>& trial_text_fields();

/// Returns the trial that a study's settings describe. Throws std::invalid_argument or CLI::Error if a value
/// is out of range.
TrialSpec trial_spec(const StudySettings& settings);

/// Returns a key for the trial's bone, made from its fields with kBoneField. Trials with the same key share a
/// bone.
std::string bone_key(const TrialSpec& asked);

/// A study from a file, and its trials. Loads each bone once.
class StudyTrials {
 public:
  /// Relative paths of scans start at `scans_from`. Throws as read_study_file does.
  StudyTrials(const std::string& file, std::filesystem::path scans_from);
  StudyTrials(const StudyTrials&) = delete;
  StudyTrials& operator=(const StudyTrials&) = delete;

  const std::string& file() const { return file_; }
  const StudyDesign& design() const { return design_; }

  /// Sets the fingerprints that bones must have from now on, by key (bone_key).
  void expect(const std::vector<std::pair<std::string, std::uint64_t>>& bones) {
    fingerprints_ = {bones.begin(), bones.end()};
  }
  const std::map<std::string, std::uint64_t>& fingerprints() const { return fingerprints_; }

  /// Returns `count` consecutive trials. They refer to this object's bones and are valid until the next call.
  /// Throws InputError, naming the file and the trial, if settings are out of range or incompatible, or if
  /// the scan is invalid or has changed.
  std::vector<TrialPlan> make(std::size_t first, std::size_t count);
  /// Returns one warning about poor settings of the trials made so far (setting_warnings), or an empty text.
  std::string settings_warning() const;

 private:
  struct Bone {
    Volume volume;
    std::string name;
    BoneDensities densities;
    // By tool, entry point and direction.
    std::map<std::string, MillingEntry> entries;
  };

  TrialPlan trial_of(const StudySettings& settings);
  Bone& bone_of(const TrialSpec& asked);
  const Volume& wall_of(const MillingTool& tool);

  std::string file_;
  std::filesystem::path scans_from_;
  StudyDesign design_;
  // Bones and fingerprints by bone_key, walls by tool. Fingerprints stay when their bones are freed.
  std::map<std::string, std::unique_ptr<Bone>> bones_;
  std::map<std::string, Volume> walls_;
  std::map<std::string, std::uint64_t> fingerprints_;
  std::set<std::size_t> warned_trials_;
  std::string first_warning_;
};

}  // namespace osteomill::app
