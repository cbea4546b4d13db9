#pragma once

#include <cstdint>
#include <string>

namespace osteomill::app {

/// Limits the memory of the named scan and all data derived from it to `bytes` more than the program uses
/// now. All functions here are safe in any thread.
void limit_memory(const std::string& scan, std::uint64_t bytes);

/// Throws InputError, naming the scan and the amounts, if the limit is exceeded. Cheap enough for frequent
/// calls from a WorkProgress listener.
void check_memory_limit();

/// Returns the message for an allocation that failed below the limit.
std::string out_of_memory_text();

}  // namespace osteomill::app
