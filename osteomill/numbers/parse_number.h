#pragma once

#include <charconv>
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

}  // namespace osteomill
