#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace osteomill {

/// Returns whether a value is finite and above 0.
inline bool is_positive(double value) {
  return std::isfinite(value) && value > 0;
}
/// Returns whether a value is finite and at least 0.
inline bool is_not_negative(double value) {
  return std::isfinite(value) && value >= 0;
}

/// Throws std::invalid_argument if a setting is not positive. `what` is its name and unit for the message.
inline void require_positive(double value, const std::string& what) {
  if (!is_positive(value)) throw std::invalid_argument(what + " must be a positive number");
}
/// Throws std::invalid_argument if a setting is negative or not finite. `what` is its name and unit for the
/// message.
inline void require_not_negative(double value, const std::string& what) {
  if (!is_not_negative(value)) throw std::invalid_argument(what + " must not be negative");
}

}  // namespace osteomill
