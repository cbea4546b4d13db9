#pragma once

#include <filesystem>

namespace osteomill {

/// Where a program keeps things of its own for this user, by the freedesktop.org rules: what it remembers
/// ($XDG_STATE_HOME/osteomill, or ~/.local/state/osteomill), and how it is set up
/// ($XDG_CONFIG_HOME/osteomill, or ~/.config/osteomill). Empty where neither is known; nothing is created.
std::filesystem::path state_folder();
std::filesystem::path config_folder();

}  // namespace osteomill
