#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "osteomill/recording/run_description.h"

namespace osteomill {

/// Reference to the exercise in the settings of a recording.
struct RecordedExercise {
  /// File as the user named it, and the fingerprint of its content.
  std::string file;
  std::string fingerprint;
  std::string title;
  /// The trainee's name, if one was given.
  std::string trainee;
  /// Whether steps, colours and distances were shown. The effect of such help does not last (Andersen 2020),
  /// so results with and without it are not comparable.
  bool has_guidance = true;
};

/// Adds the exercise to the run's settings.
void put_exercise(RunDescription& run, const RecordedExercise& exercise);
/// Returns the run's exercise; nothing if it had none.
std::optional<RecordedExercise> recorded_exercise(const RunDescription& run);

/// Returns a hash of a file's content in hexadecimal. Throws InputError if the file cannot be read.
std::string text_fingerprint(const std::filesystem::path& file);

}  // namespace osteomill
