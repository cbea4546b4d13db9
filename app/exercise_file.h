#pragma once

#include <string>

#include "osteomill/exercise/exercise.h"

namespace osteomill::app {

/// Reads an exercise (docs/exercises.md). Throws InputError, naming the file and the line, for an unknown
/// key, a missing value, or one of the wrong type or out of range. place_exercise later checks shapes and
/// labels against the scan.
Exercise read_exercise_file(const std::string& file);

}  // namespace osteomill::app
