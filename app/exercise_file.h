#pragma once

#include <string>

#include "osteomill/exercise/exercise.h"

namespace osteomill::app {

/// Reads an exercise (docs/exercises.md). Throws InputError, naming the file and the line, for an unknown
/// key, a value of another kind or out of range, or a missing one. Shapes and labels are held against the
/// scan later (place_exercise).
Exercise read_exercise_file(const std::string& file);

}  // namespace osteomill::app
