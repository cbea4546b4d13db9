#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

namespace osteomill::verification {

/// Calls `job(0)` to `job(count - 1)`, as many at a time as there are cores.
inline void in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t n = next++; n < count; n = next++) job(n);
  };
  std::vector<std::jthread> threads;
  const auto wanted = std::max(1U, std::thread::hardware_concurrency());
  for (unsigned n = 0; n < wanted; ++n) threads.emplace_back(work);
}

}  // namespace osteomill::verification
