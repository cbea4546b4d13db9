#pragma once

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

namespace osteomill::testing_support {

/// Returns the position of a handle that no test holds: it advances along an axis with a small oscillation.
inline double swept_mm() {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  const double time_s = std::chrono::duration<double>(Clock::now() - start).count();
  return 25 * time_s + 3 * std::sin(2 * std::numbers::pi * time_s);
}

/// Appends a line with data received by a stand-in to the file named in OSTEOMILL_STAND_IN_LOG, if set.
template <typename... Words>
void log_of_stand_in(const Words&... words) {
  const char* const file = std::getenv("OSTEOMILL_STAND_IN_LOG");
  if (file == nullptr) return;
  std::ofstream log(file, std::ios::app);
  ((log << words << ' '), ...) << '\n';
}

}  // namespace osteomill::testing_support
