#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace osteomill {

/// Returns the number that a text is as a whole, whatever the locale ("nan" and "inf" are numbers here);
/// nothing if it is none.
template <typename Number>
std::optional<Number> parsed_number(std::string_view text) {
  Number number = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return number;
}

/// Returns the finite number that a text is as a whole, whatever the locale; nothing if it is none. Every
/// option and every field that holds a number is read by this function.
inline std::optional<double> parsed_finite(std::string_view text) {
  const auto number = parsed_number<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

}  // namespace osteomill
