#pragma once

#include <optional>
#include <string>

#include <CLI/App.hpp>

#include "osteomill/exercise/placed_exercise.h"
#include "osteomill/exercise/recorded_exercise.h"
#include "osteomill/recording/recording.h"
#include "osteomill/session/milling_setup.h"

#include "app/scan_options.h"

namespace osteomill::app {

/// The exercise options of a command.
struct ExerciseOptions {
  std::string file;
  std::string trainee;
  /// Whether the window shows steps, colours and distances.
  bool has_guidance = false;

  bool given() const { return !file.empty(); }
};

/// Adds --exercise and --trainee.
void add_exercise_options(CLI::App& command, ExerciseOptions& options);
/// Adds --no-guidance and turns guidance on by default.
void add_guidance_option(CLI::App& command, ExerciseOptions& options);

/// An exercise with its scan.
struct LoadedExercise {
  LoadedBone bone;
  PlacedExercise placed;
};
/// Reads an exercise and its scan, prints the scan's warnings to standard error, and places the exercise.
/// Marks no-go structures of the label map in the bone's labels. With a recording, reads the scan as for the
/// recording. Throws InputError naming the file and the line if the exercise is invalid, or the recording if
/// it was made with another scan; also throws as `scan_of` and `load_bone` do.
LoadedExercise load_exercise(const std::string& file, const ScanOptions& options,
                             const Recording* recording = nullptr);

/// The bone to mill, from an exercise or a scan.
struct BoneToMill {
  LoadedBone bone;
  /// The options with which the bone was read.
  ScanOptions scan;
  /// The exercise's entry for recordings, and its entry point; both empty without an exercise.
  std::optional<RecordedExercise> exercise;
  std::optional<Vec3> entry_W_mm;
};
/// Loads the bone of the exercise if one is given, otherwise of the scan. Throws as `load_exercise`,
/// `require_allowed_burr` and `load_bone` do.
BoneToMill load_bone_to_mill(const ExerciseOptions& exercise, const ScanOptions& options,
                             const MillingSetup& setup);

/// Returns `options` with the exercise's scan, isovalue and labels. Throws CLI::ValidationError if the user
/// has given any of these.
ScanOptions scan_of(const Exercise& exercise, const ScanOptions& options);

/// Throws InputError, naming the exercise, if its burrs do not include the setup's.
void require_allowed_burr(const Exercise& exercise, const MillingSetup& setup);
/// Replaces the setup's burr by the exercise's burr of the nearest radius, unless the exercise
/// already allows the setup's.
void select_allowed_burr(const Exercise& exercise, MillingSetup& setup);

/// Returns the exercise's entry for a recording.
RecordedExercise make_recorded_exercise(const Exercise& exercise, const ExerciseOptions& options);

}  // namespace osteomill::app
