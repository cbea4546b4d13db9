#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#ifdef __SSE2__  // every x86-64 has it
#include <emmintrin.h>
#endif

namespace osteomill {

/// Returns a bit mask: bit n is set if row[n] > limit, for n below `count`, a multiple of 4 up to 32. Safe in
/// the haptic tick.
inline std::uint32_t bits_above(const float* row, int count, float limit) {
  std::uint32_t bits = 0;
#ifdef __SSE2__
  const __m128 limits = _mm_set1_ps(limit);
  for (int n = 0; n < count; n += 4) {
    const int four = _mm_movemask_ps(_mm_cmpgt_ps(_mm_loadu_ps(row + n), limits));
    bits |= static_cast<std::uint32_t>(four) << n;
  }
#else
  for (int n = 0; n < count; ++n) bits |= static_cast<std::uint32_t>(row[n] > limit) << n;
#endif
  return bits;
}

/// Returns the largest float not above `value`. Any float exceeds `value` exactly if it exceeds this one.
inline float largest_float_up_to(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  const float nearest = static_cast<float>(std::clamp(value, -kMax, kMax));
  return static_cast<double>(nearest) > value
             ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
             : nearest;
}

}  // namespace osteomill
