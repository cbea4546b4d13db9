#pragma once

#include <filesystem>

namespace osteomill::app {

/// Where the program remembers things of its own: $XDG_STATE_HOME/osteomill, or ~/.local/state/osteomill;
/// empty where neither is known.
std::filesystem::path state_folder();

/// True until this was called once on this machine by this user: leaves a marker in `state_folder()`. Where
/// none can be left, which is no error, every time is the first.
bool first_time_of_help();

}  // namespace osteomill::app
