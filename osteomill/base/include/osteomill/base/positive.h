#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace osteomill {

/// Finite and above 0.
inline bool is_positive(double value) {
  return std::isfinite(value) && value > 0;
}
/// Finite and not below 0.
inline bool is_not_negative(double value) {
  return std::isfinite(value) && value >= 0;
}

/// Throws std::invalid_argument where the setting `what` (as a reader is told, with its unit) is not
/// positive.
inline void require_positive(double value, const std::string& what) {
  if (!is_positive(value)) throw std::invalid_argument(what + " must be a positive number");
}
/// Throws std::invalid_argument where it is negative or not finite.
inline void require_not_negative(double value, const std::string& what) {
  if (!is_not_negative(value)) throw std::invalid_argument(what + " must not be negative");
}

}  // namespace osteomill
