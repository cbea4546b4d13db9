#pragma once

#include <cstddef>
#include <functional>

namespace osteomill {

/// Calls `task(n)` for each n below `count` on up to `threads` threads at once, in any order, and `done` with
/// how many are finished, one call at a time. Tasks must not share anything that they change. Throws what the
/// first task threw that failed, after all that had begun are over; no others are begun then.
void run_in_parallel(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task,
                     const std::function<void(std::size_t)>& done);

}  // namespace osteomill
