#pragma once

#include <cstdint>
#include <string>

namespace osteomill::app {

/// From now on the scan of this name, with all that is made of it, may take this many bytes of memory more
/// than the program takes now. Any thread, as all of these.
void limit_memory(const std::string& scan, std::uint64_t bytes);

/// Throws InputError, naming scan and amounts, where more is taken. Cheap, to be called often, as by a
/// listener of WorkProgress.
void check_memory_taken();

/// What to say, in one line, where memory ran out before the limit was reached.
std::string out_of_memory_text();

}  // namespace osteomill::app
