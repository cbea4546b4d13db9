#pragma once

#include <string>

namespace osteomill {

/// Free text as a field of a CSV file (RFC 4180): in quotes where it holds what separates fields or rows.
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace osteomill
