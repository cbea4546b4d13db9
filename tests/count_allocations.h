#pragma once

namespace osteomill::testing_support {

/// Returns how often this thread has allocated (malloc, calloc, realloc, aligned_alloc, new) since it began.
/// Counts only if count_allocations.cpp is linked in.
long allocations_of_this_thread();

}  // namespace osteomill::testing_support
