#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace osteomill {

/// Parses the whole text as a number, independent of the locale; accepts "nan" and "inf". Returns nothing if
/// it is not a number.
template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  Number number = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return number;
}

/// Parses the whole text as a finite number, independent of the locale. Returns nothing if it is not one.
/// Every numeric option and field is read by this function.
inline std::optional<double> parse_finite(std::string_view text) {
  const auto number = parse_number<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

}  // namespace osteomill
