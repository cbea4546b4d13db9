#include "trials/csv_table.h"

#include <cstddef>
#include <fstream>
#include <string_view>

#include "osteomill/base/csv_field.h"
#include "osteomill/base/read_line.h"

namespace osteomill {

namespace {

// A line that is too long ends the table: this program does not write any.
bool next_line(std::istream& in, std::string& line) {
  constexpr std::size_t kMaxLine = 16384;
  try {
    return read_line(in, line, kMaxLine);
  } catch (const LineTooLong&) {
    return false;
  }
}

}  // namespace

std::vector<std::vector<std::string>> read_csv_table(const std::filesystem::path& path,
                                                     const std::string& head) {
  std::ifstream in(path);
  std::string line;
  std::vector<std::vector<std::string>> rows;
  if (!next_line(in, line) || line != head) return rows;
  while (next_line(in, line)) {
    const std::vector<std::string_view> cells = csv_fields(line);
    rows.emplace_back(cells.begin(), cells.end());
  }
  return rows;
}

}  // namespace osteomill
