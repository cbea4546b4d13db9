#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace osteomill {

/// Returns the word as it would be typed into a shell, in quotes if it has to be.
std::string quoted(const std::string& word);

/// The text that another program printed, on both its outputs, and its exit code (run_program()).
struct ProcessResult {
  /// The exit code of a shell when there is no such program.
  static constexpr int kNoProgram = 127;
  int exit_code = 0;
  std::string text;
};
/// Runs a program, found as a shell finds it, with no input and to its end; keeps the first 16 MB of what it
/// prints. Throws InputError if it cannot be started, or does not end within `limit`; it is ended then, with
/// all that it has started.
ProcessResult run_program(const std::vector<std::string>& words,
                          std::chrono::duration<double> limit = std::chrono::minutes(5));

}  // namespace osteomill
