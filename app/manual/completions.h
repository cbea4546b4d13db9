#pragma once

#include <string>
#include <vector>

#include "app/manual/command_tree.h"

namespace osteomill::app {

/// Return the script that completes osteomill's commands, options and values in a shell.
std::string bash_completion(const std::vector<CommandText>& program_and_commands);
std::string zsh_completion(const std::vector<CommandText>& program_and_commands);
std::string fish_completion(const std::vector<CommandText>& program_and_commands);

}  // namespace osteomill::app
