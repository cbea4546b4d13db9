#pragma once

#include <string>
#include <string_view>

namespace osteomill {

/// Returns whether a text is valid UTF-8.
bool is_utf8(std::string_view text);

/// Converts Latin 1 to UTF-8.
std::string utf8_of_latin1(std::string_view text);

/// Replaces every control character (C0, DEL and C1) of a UTF-8 text by `instead`.
std::string without_controls(std::string_view text, char instead);

}  // namespace osteomill
