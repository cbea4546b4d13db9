#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace osteomill {

/// Returns free text as a CSV field (RFC 4180), quoted if it contains a comma, a quote or a line break.
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

/// Splits a row without quoted fields into its fields and strips the blanks around each.
inline std::vector<std::string_view> csv_fields(std::string_view row) {
  if (row.ends_with('\r')) row.remove_suffix(1);
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t comma = row.find(',');
    std::string_view field = row.substr(0, comma);
    while (field.starts_with(' ')) field.remove_prefix(1);
    while (field.ends_with(' ')) field.remove_suffix(1);
    fields.push_back(field);
    if (comma == std::string_view::npos) return fields;
    row.remove_prefix(comma + 1);
  }
}

}  // namespace osteomill
