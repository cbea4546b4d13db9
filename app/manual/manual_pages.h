#pragma once

#include <string>
#include <vector>

#include "app/manual/command_tree.h"

namespace osteomill::app {

/// The version and date ("2026-11-26") of every manual page.
struct Edition {
  std::string version;
  std::string date;
};

/// Returns osteomill(1) in man(7) format: commands by group, files, environment and exit status.
std::string program_page(const std::vector<CommandText>& program_and_commands, const Edition& edition);

/// Returns osteomill-COMMAND(1): every argument and option of the command.
std::string command_page(const CommandText& command, const Edition& edition);

}  // namespace osteomill::app
