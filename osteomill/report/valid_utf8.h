#pragma once

#include <string>
#include <string_view>

namespace osteomill {

/// The text with U+FFFD for every byte that is no part of a character in UTF-8 (RFC 3629): names in scans,
/// and of files, may be of other encodings.
std::string valid_utf8(std::string_view text);

}  // namespace osteomill
