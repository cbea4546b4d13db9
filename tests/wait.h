#pragma once

#include <chrono>
#include <thread>

namespace osteomill::testing_support {

/// Polls the condition every few milliseconds. Returns true as soon as it holds, or false after a timeout
/// that is long enough for a busy machine.
template <typename Condition>
bool becomes_true_in_time(const Condition& condition) {
  using namespace std::chrono_literals;
  const auto last = std::chrono::steady_clock::now() + 20s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > last) return condition();
    std::this_thread::sleep_for(2ms);
  }
  return true;
}

}  // namespace osteomill::testing_support
