#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace osteomill {

/// Returns the word as typed into a shell, quoted if necessary.
std::string quoted(const std::string& word);

/// Combined standard output and error of a program, and its exit code (run_program()).
struct ProcessResult {
  /// The shell's exit code for a program that does not exist.
  static constexpr int kNoProgram = 127;
  int exit_code = 0;
  std::string text;
};
/// Runs a program, looked up in PATH, without input, and waits for it to end; keeps the first 16 MB of its
/// output. Throws InputError if it cannot be started, or does not end within `limit`; it is then killed with
/// all its child processes.
ProcessResult run_program(const std::vector<std::string>& words,
                          std::chrono::duration<double> limit = std::chrono::minutes(5));

}  // namespace osteomill
