#pragma once

#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/exercise/recorded_exercise.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"

#include "app/exercise_options.h"
#include "app/scan_options.h"

namespace osteomill::app {

/// The recording and the time in it at which a command continues.
struct BranchOptions {
  std::string recording;
  double at_s = 0;

  bool given() const { return !recording.empty(); }
};
/// Adds --from and --at, each of which needs the other.
void add_branch_options(CLI::App& command, BranchOptions& options);

/// Throws CLI::ValidationError if an option of the scan, the tool or the algorithm was given, because the
/// recording defines these.
void refuse_recorded_options(const CLI::App& command);

/// A recording with its scan, read as for the recording, and its exercise if it has one.
struct LoadedRecording {
  Recording recording;
  LoadedBone bone;
  ScanOptions scan;
  std::optional<PlacedExercise> placed;
  std::optional<RecordedExercise> exercise;
};
/// Reads a recording with its scan and exercise. Those named in `scan` and `exercise` take precedence over
/// the recorded ones. Throws InputError naming the recording if it was made with another scan or exercise.
LoadedRecording load_recording(const std::string& recording, const ScanOptions& scan,
                               const ExerciseOptions& exercise);

/// A resumed recording that a command continues.
struct Branch {
  LoadedRecording work;
  ResumedRecording resumed;
  BranchPoint from;
};
/// Reads the recording and resumes it. Throws as `load_recording` and `resume_recording` do. Long work.
Branch open_branch(const BranchOptions& options, const ScanOptions& scan, const ExerciseOptions& exercise);

}  // namespace osteomill::app
