#pragma once

#include <string>

namespace osteomill::app {

/// How the program was called, as it would be typed into a shell, the program as "osteomill".
std::string command_line_of(int argc, const char* const* argv);

}  // namespace osteomill::app
