#pragma once

#include <cstddef>
#include <istream>
#include <stdexcept>
#include <string>

namespace osteomill {

/// Thrown by read_line() for a line that exceeds its limit.
class LineTooLong : public std::length_error {
 public:
  LineTooLong() : std::length_error("a line is too long") {}
};

/// Reads the next line into `line`, without its line end. Returns false at the end of the stream. Throws
/// LineTooLong beyond `max_bytes`, so that a file without line ends cannot exhaust memory.
inline bool read_line(std::istream& in, std::string& line, std::size_t max_bytes) {
  constexpr int kEnd = std::char_traits<char>::eof();
  line.clear();
  if (in.rdbuf() == nullptr || !in) return false;
  std::streambuf& bytes = *in.rdbuf();
  int byte = bytes.sbumpc();
  if (byte == kEnd) return false;
  for (; byte != '\n' && byte != kEnd; byte = bytes.sbumpc()) {
    if (line.size() == max_bytes) throw LineTooLong();
    line += static_cast<char>(byte);
  }
  return true;
}

}  // namespace osteomill
