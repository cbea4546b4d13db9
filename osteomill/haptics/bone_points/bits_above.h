#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#ifdef __SSE2__  // every x86-64 has it
#include <emmintrin.h>
#endif

namespace osteomill {

/// Bit n: whether row[n] > limit, n from 0 to 7. Safe in the haptic tick.
inline std::uint8_t eight_above(const float* row, float limit) {
#ifdef __SSE2__
  const __m128 limits = _mm_set1_ps(limit);
  const int low = _mm_movemask_ps(_mm_cmpgt_ps(_mm_loadu_ps(row), limits));
  const int high = _mm_movemask_ps(_mm_cmpgt_ps(_mm_loadu_ps(row + 4), limits));
  return static_cast<std::uint8_t>(low | high << 4);
#else
  unsigned bits = 0;
  for (int n = 0; n < 8; ++n) bits |= static_cast<unsigned>(row[n] > limit) << n;
  return static_cast<std::uint8_t>(bits);
#endif
}

/// What a float has to be above to be above `value`.
inline float largest_float_up_to(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) > value
             ? std::nextafter(nearest, -std::numeric_limits<float>::infinity())
             : nearest;
}

}  // namespace osteomill
