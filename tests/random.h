#pragma once

#include <random>

#include "osteomill/base/pose.h"

namespace osteomill::testing_support {

inline double uniform(std::mt19937& bits, double from, double to) {
  return from + (to - from) * (static_cast<double>(bits()) / 4294967295.0);
}

/// Returns a vector with components uniform in -1..1.
inline Vec3 random_vector(std::mt19937& bits) {
  const double x = uniform(bits, -1, 1), y = uniform(bits, -1, 1), z = uniform(bits, -1, 1);
  return {x, y, z};
}

}  // namespace osteomill::testing_support
