#pragma once

#include <cstdint>
#include <string>

namespace osteomill::app {

/// Allows the scan of this name, with all that is made of it, this many bytes of memory more than the program
/// takes now. From any thread, as all functions here.
void limit_memory(const std::string& scan, std::uint64_t bytes);

/// Throws InputError, naming scan and amounts, if more is taken. Cheap, so that a listener of WorkProgress
/// can call it often.
void check_memory_taken();

/// Returns the line to print if memory ran out before the limit was reached.
std::string out_of_memory_text();

}  // namespace osteomill::app
