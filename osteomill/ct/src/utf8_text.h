#pragma once

#include <string>
#include <string_view>

namespace osteomill {

/// Returns whether all bytes are characters in UTF-8.
bool is_utf8(std::string_view text);

/// Returns Latin 1 in UTF-8.
std::string utf8_of_latin1(std::string_view text);

/// Returns UTF-8 with `instead` for every control character: C0, DEL and C1.
std::string without_controls(std::string_view text, char instead);

}  // namespace osteomill
