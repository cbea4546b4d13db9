#pragma once

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>

namespace osteomill::testing_support {

/// Where a stand-in's handle is when nobody holds it: along an axis to and fro, once in two seconds.
inline double swept_mm() {
  const std::chrono::duration<double> now = std::chrono::steady_clock::now().time_since_epoch();
  return 30 * std::sin(std::numbers::pi * now.count());
}

/// What a stand-in was sent, as a line in the file that OSTEOMILL_STAND_IN_LOG names; nowhere without it.
template <typename... Words>
void log_of_stand_in(const Words&... words) {
  const char* const file = std::getenv("OSTEOMILL_STAND_IN_LOG");
  if (file == nullptr) return;
  std::ofstream log(file, std::ios::app);
  ((log << words << ' '), ...) << '\n';
}

}  // namespace osteomill::testing_support
