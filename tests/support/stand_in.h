#pragma once

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

namespace osteomill::testing_support {

/// Returns the position of a stand-in's handle that no test holds: ever further along an axis, and a little
/// back and forth.
inline double swept_mm() {
  using Clock = std::chrono::steady_clock;
  static const Clock::time_point start = Clock::now();
  const double time_s = std::chrono::duration<double>(Clock::now() - start).count();
  return 25 * time_s + 3 * std::sin(2 * std::numbers::pi * time_s);
}

/// Writes what a stand-in was sent as a line into the file that OSTEOMILL_STAND_IN_LOG names; does nothing
/// without it.
template <typename... Words>
void log_of_stand_in(const Words&... words) {
  const char* const file = std::getenv("OSTEOMILL_STAND_IN_LOG");
  if (file == nullptr) return;
  std::ofstream log(file, std::ios::app);
  ((log << words << ' '), ...) << '\n';
}

}  // namespace osteomill::testing_support
