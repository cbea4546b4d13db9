#include "utf8_text.h"

#include <algorithm>
#include <cstddef>

namespace osteomill {

namespace {

// Returns the length of the UTF-8 character at the start of `text`; 0 if it is invalid.
std::size_t length_of_utf8(std::string_view text) {
  const auto byte = [&](std::size_t n) {
    return n < text.size() ? static_cast<unsigned>(static_cast<unsigned char>(text[n])) : 0;
  };
  const auto follows = [&](std::size_t n) { return (byte(n) & 0xC0) == 0x80; };
  if (byte(0) < 0x80) return 1;
  if (byte(0) >= 0xC2 && byte(0) < 0xE0 && follows(1)) return 2;
  // Rejects overlong forms and surrogates.
  const unsigned two = byte(0) << 8 | byte(1);
  if (two >= 0xE0A0 && two < 0xF000 && follows(1) && follows(2) && !(two >= 0xEDA0 && two < 0xEE00)) return 3;
  if (two >= 0xF090 && two < 0xF490 && follows(1) && follows(2) && follows(3)) return 4;
  return 0;
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = length_of_utf8(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string utf8_of_latin1(std::string_view text) {
  std::string utf8;
  for (const char letter : text) {
    const auto code = static_cast<unsigned char>(letter);
    if (code >= 0x80) utf8 += static_cast<char>(0xC0 | code >> 6);
    utf8 += static_cast<char>(code >= 0x80 ? 0x80 | (code & 0x3F) : code);
  }
  return utf8;
}

std::string without_controls(std::string_view text, char instead) {
  std::string shown;
  while (!text.empty()) {
    const std::string_view character = text.substr(0, std::max<std::size_t>(1, length_of_utf8(text)));
    const auto first = static_cast<unsigned char>(character[0]);
    const bool is_control = character.size() == 1
                                ? first < ' ' || first == 127
                                : first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0;
    shown += is_control ? std::string_view(&instead, 1) : character;
    text.remove_prefix(character.size());
  }
  return shown;
}

}  // namespace osteomill
