#pragma once

#include <cstddef>
#include <functional>

#include "osteomill/base/machine.h"
#include "osteomill/study/parallel.h"

namespace osteomill::verification {

/// Calls `job(0)` to `job(count - 1)`, as many at a time as there are cores. Throws what the first job threw.
inline void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
  run_in_parallel(count, allowed_threads(), job, [](std::size_t) {});
}

}  // namespace osteomill::verification
