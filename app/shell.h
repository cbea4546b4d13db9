#pragma once

#include <string>
#include <vector>

namespace osteomill::app {

/// The word as it would be typed into a shell.
std::string quoted(const std::string& word);

/// What another program said, on both its outputs, and how it ended; 127 where there is no such program.
struct Said {
  int exit_code = 0;
  std::string text;
};
/// Runs it to its end. Throws InputError where it cannot be started.
Said run_program(const std::vector<std::string>& words);

}  // namespace osteomill::app
