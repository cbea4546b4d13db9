#pragma once

namespace osteomill::testing_support {

/// Returns the number of allocations (malloc, calloc, realloc, aligned_alloc, new) of this thread since its
/// start. Counts only if count_allocations.cpp is linked in.
long allocations_of_this_thread();

}  // namespace osteomill::testing_support
