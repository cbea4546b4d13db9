#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace osteomill {

/// The number that a text is as a whole, whatever the locale ("nan" and "inf" are numbers here); nothing
/// where it is none.
template <typename Number>
std::optional<Number> parsed_number(std::string_view text) {
  Number number = 0;
  const char* const end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return number;
}

/// The finite number that a text is as a whole, whatever the locale; nothing where it is none. Every option
/// and every field that holds a number is read by this.
inline std::optional<double> parsed_finite(std::string_view text) {
  const auto number = parsed_number<double>(text);
  return number && std::isfinite(*number) ? number : std::nullopt;
}

}  // namespace osteomill
