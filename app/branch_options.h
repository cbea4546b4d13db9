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

/// The tick of a recording from which a command goes on.
struct BranchOptions {
  std::string recording;
  double at_s = 0;

  bool given() const { return !recording.empty(); }
};
/// Adds --from and --at, each of which needs the other.
void add_branch_options(CLI::App& command, BranchOptions& options);

/// Throws CLI::ValidationError if an option was given whose value a recording has: its scan's, its tool's,
/// its algorithm's.
void refuse_recorded_options(const CLI::App& command);

/// A recording with its scan, as it was read for it, and its exercise, if it is of one.
struct RecordedWork {
  Recording recording;
  LoadedBone bone;
  ScanOptions scan;
  std::optional<PlacedExercise> placed;
  std::optional<RecordedExercise> exercise;
};
/// Reads them. The scan and the exercise that are named in `scan` and `exercise` go before the recorded ones.
/// Throws InputError that names the recording if it is of another scan or exercise than are there.
RecordedWork read_recorded_work(const std::string& recording, const ScanOptions& scan,
                                const ExerciseOptions& exercise);

/// A recording that was resumed, for a command that goes on from it.
struct Branch {
  RecordedWork work;
  ResumedRecording resumed;
  BranchPoint from;
};
/// Reads the recording and resumes it. Throws as `read_recorded_work` and `resume_recording` do. Long work.
Branch open_branch(const BranchOptions& options, const ScanOptions& scan, const ExerciseOptions& exercise);

}  // namespace osteomill::app
