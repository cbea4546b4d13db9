#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "osteomill/recording/run_description.h"

namespace osteomill {

/// The exercise that was worked on, as a recording names it in the settings of its run.
struct RecordedExercise {
  /// The file as the user named it, and the fingerprint of its text.
  std::string file;
  std::string fingerprint;
  std::string title;
  /// The trainee's name, if one was given.
  std::string trainee;
  /// Whether steps, colours and distances were shown. Help that is on while working does not last (Andersen
  /// 2020), so results with and without it are not alike.
  bool has_guidance = true;
};

/// Puts the exercise among the run's settings.
void put_exercise(RunDescription& run, const RecordedExercise& exercise);
/// Returns what the run says; nothing if it was none of an exercise.
std::optional<RecordedExercise> recorded_exercise(const RunDescription& run);

/// Returns a number in hexadecimal that two texts hardly share. Throws InputError if the file cannot be read.
std::string text_fingerprint(const std::filesystem::path& file);

}  // namespace osteomill
