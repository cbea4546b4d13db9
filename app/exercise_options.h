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

/// The options of a command that can be worked as an exercise.
struct ExerciseOptions {
  std::string file;
  std::string trainee;
  /// Whether steps, colours and distances are shown, which only the window does.
  bool has_guidance = false;

  bool given() const { return !file.empty(); }
};

/// Adds --exercise and --trainee.
void add_exercise_options(CLI::App& command, ExerciseOptions& options);
/// Adds --no-guidance to a command that shows guidance otherwise.
void add_guidance_option(CLI::App& command, ExerciseOptions& options);

/// An exercise on its scan.
struct LoadedExercise {
  LoadedBone bone;
  PlacedExercise placed;
};
/// Reads an exercise and its scan, prints the scan's warnings to standard error, and places the exercise. If
/// structures of the label map must not be touched, the bone's labels say so. Throws InputError, naming the
/// file and the line, if the exercise is at fault; and as `scan_of` and `load_bone`. If there is a recording,
/// the scan is read as it was for it, and InputError names the recording if it is of another scan.
LoadedExercise load_exercise(const std::string& file, const ScanOptions& options,
                             const Recording* recording = nullptr);

/// The bone of a command that works on an exercise or on a scan.
struct BoneToMill {
  LoadedBone bone;
  /// How the bone was read.
  ScanOptions scan;
  /// Both are nothing without an exercise: the text that recordings have of it, and where it is entered.
  std::optional<RecordedExercise> exercise;
  std::optional<Vec3> entry_W_mm;
};
/// Loads the exercise's bone if one is given, else the scan's. Throws as `load_exercise`,
/// `require_allowed_burr` and `load_bone`.
BoneToMill load_bone_to_mill(const ExerciseOptions& exercise, const ScanOptions& options,
                             const MillingSetup& setup);

/// Returns `options` with the exercise's scan, isovalue and labels in the place of the user's own. Throws
/// CLI::ValidationError if the user has named any of these.
ScanOptions scan_of(const Exercise& exercise, const ScanOptions& options);

/// Throws InputError, naming the exercise, if its burrs do not include the setup's.
void require_allowed_burr(const Exercise& exercise, const MillingSetup& setup);
/// Puts that burr of the exercise into the setup which is nearest to its own, unless it has one of them.
void take_allowed_burr(const Exercise& exercise, MillingSetup& setup);

/// Returns what a recording says of the exercise.
RecordedExercise to_be_recorded(const Exercise& exercise, const ExerciseOptions& options);

}  // namespace osteomill::app
