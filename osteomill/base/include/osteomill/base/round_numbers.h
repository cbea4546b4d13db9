#pragma once

#include <cmath>
#include <initializer_list>

namespace osteomill {

/// Returns the largest round number (1, 2 or 5 times a power of ten) not above a positive value.
inline double round_down(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double times : {5.0, 2.0}) {
    if (times * power <= value) return times * power;
  }
  return power;
}

/// Returns the smallest round number (1, 2 or 5 times a power of ten) not below a positive value.
inline double round_up(double value) {
  return 1 / round_down(1 / value);
}

}  // namespace osteomill
