#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace osteomill {

/// The word as it would be typed into a shell.
std::string quoted(const std::string& word);

/// What another program said, on both its outputs, and how it ended.
struct Said {
  /// Of a shell for programs that are not there.
  static constexpr int kNoProgram = 127;
  int exit_code = 0;
  std::string text;
};
/// Runs a program, found as a shell finds it, with no input and to its end; of what it prints the first
/// 16 MB are kept. Throws InputError if it cannot be started, or does not end within `limit`: it is ended
/// then, with what it has started.
Said run_program(const std::vector<std::string>& words,
                 std::chrono::duration<double> limit = std::chrono::minutes(5));

}  // namespace osteomill
