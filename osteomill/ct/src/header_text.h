#pragma once

#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/base/parse_number.h"

namespace osteomill {

/// Parses the numbers of a header field, separated by any of `separators`; returns nullopt if one is not a
/// number. Accepts "nan" and "inf": callers that need finite numbers must check.
inline std::optional<std::vector<double>> parse_numbers(std::string_view text,
                                                        std::string_view separators = " \t\r\n") {
  std::vector<double> numbers;
  while (true) {
    const std::size_t start = text.find_first_not_of(separators);
    if (start == std::string_view::npos) return numbers;
    text.remove_prefix(start);
    const std::size_t length = std::min(text.find_first_of(separators), text.size());
    std::string_view piece = text.substr(0, length);
    if (piece.front() == '+') piece.remove_prefix(1);
    const auto number = parse_number<double>(piece);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
    text.remove_prefix(length);
  }
}

/// Returns `text` without leading and trailing blanks.
inline std::string trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r");
  if (start == std::string_view::npos) return {};
  return std::string(text.substr(start, text.find_last_not_of(" \t\r") - start + 1));
}
inline std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace osteomill
