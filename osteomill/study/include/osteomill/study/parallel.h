#pragma once

#include <cstddef>
#include <functional>

namespace osteomill {

/// Calls `task(n)` for each n below `count` on up to `threads` threads, in any order, and `done` with the
/// number of finished tasks, one call at a time. Tasks must not share mutable state. If a task throws, starts
/// no further ones, waits for those already running, and rethrows the first exception.
void run_in_parallel(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& task,
                     const std::function<void(std::size_t)>& done);

}  // namespace osteomill
