#pragma once

#include <cstddef>
#include <functional>

#include "osteomill/base/machine.h"
#include "osteomill/study/parallel.h"

namespace osteomill::verification {

/// Calls `job(0)` to `job(count - 1)`, one per core at a time. Rethrows the first exception of a job.
inline void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
  run_in_parallel(count, allowed_threads(), job, [](std::size_t) {});
}

}  // namespace osteomill::verification
