#pragma once

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
/// Runs a program, found as a shell finds it, with no input and to its end. Throws InputError where it cannot
/// be started.
Said run_program(const std::vector<std::string>& words);

}  // namespace osteomill
