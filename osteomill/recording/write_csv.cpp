#include "osteomill/recording/write_csv.h"

#include <iterator>
#include <ostream>

#include <fmt/format.h>

#include "osteomill/files/atomic_file.h"
#include "osteomill/recording/record_columns.h"

namespace osteomill {

namespace {

void append_header(fmt::memory_buffer& text) {
  const char* separator = "";
  for (const RecordColumn& column : record_columns()) {
    if (!column.in_log) continue;
    fmt::format_to(std::back_inserter(text), "{}{}", separator, column.name);
    separator = ",";
  }
  text.push_back('\n');
}

void append_row(fmt::memory_buffer& text, const TickRecord& record) {
  const char* separator = "";
  for (const RecordColumn& column : record_columns()) {
    if (!column.in_log) continue;
    fmt::format_to(std::back_inserter(text), "{}{}", separator, column.get(record));
    separator = ",";
  }
  text.push_back('\n');
}

}  // namespace

void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records) {
  write_text_atomically(path, [&](std::ostream& out) {
    fmt::memory_buffer text;
    append_header(text);
    for (const TickRecord& record : records) {
      append_row(text, record);
      out.write(text.data(), static_cast<std::streamsize>(text.size()));
      text.clear();
    }
    out.write(text.data(), static_cast<std::streamsize>(text.size()));
  });
}

}  // namespace osteomill
