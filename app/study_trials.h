#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/scan_options.h"
#include "app/trial_options.h"
#include <CLI/App.hpp>

#include "osteomill/experiment/run_trials.h"
#include "osteomill/experiment/study_design.h"

namespace osteomill::app {

/// A study as its file describes it, and its trials, each made of what is set of it by the options of
/// `compare` and some that only a study has. Opens every bone once.
class StudyTrials {
 public:
  /// Scans are sought from the folder `scans_from`. Throws as read_study_file does.
  StudyTrials(const std::string& file, std::filesystem::path scans_from);
  StudyTrials(const StudyTrials&) = delete;
  StudyTrials& operator=(const StudyTrials&) = delete;

  const StudyDesign& design() const { return design_; }

  /// Bones are then to have these fingerprints, by what is set of them.
  void expect(const std::vector<std::pair<std::string, std::uint64_t>>& bones) {
    fingerprints_ = {bones.begin(), bones.end()};
  }
  const std::map<std::string, std::uint64_t>& fingerprints() const { return fingerprints_; }

  /// Trials that follow each other. They hold on to this object's bones: until the next call. Throws
  /// InputError, naming the file and the trial, where a setting is out of its range or does not go with the
  /// others, or where its scan is at fault or has changed.
  std::vector<TrialPlan> make(std::size_t first, std::size_t count);

 private:
  // Where `command_` writes what is set of a trial; the options of `compare` and those that only a study has.
  struct Asked {
    ScanOptions scan;
    TrialOptions trial;
    double voxel_mm = 0.125;
    double rate_hz = 1000;
    double device_damping_Ns_per_mm = 0.005;
    double grip = 1;
    bool draw_hand = false;
  };
  struct Bone {
    Volume volume;
    std::string name;
    BoneDensities densities;
    // By tool, place and direction.
    std::map<std::string, MillingEntry> entries;
  };

  // Adds the options that a trial has, and reads the file, which names them.
  StudyDesign read_design();
  std::vector<std::string> keys() const;
  StudySettings units() const;
  void take(const StudySettings& settings);
  TrialPlan trial_of(const StudySettings& settings);
  Bone& bone_of(const StudySettings& settings);
  const Volume& wall_of(const MillingTool& tool);

  std::string file_;
  std::filesystem::path scans_from_;
  Asked asked_;
  CLI::App command_;
  StudyDesign design_;
  // By what is set of the scan; walls by the tool. A bone's fingerprint stays when the bone itself is let go.
  std::map<std::string, std::unique_ptr<Bone>> bones_;
  std::map<std::string, Volume> walls_;
  std::map<std::string, std::uint64_t> fingerprints_;
};

}  // namespace osteomill::app
