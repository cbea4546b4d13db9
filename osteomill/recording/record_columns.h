#pragma once

#include <filesystem>
#include <span>

#include "osteomill/session/tick_record.h"

namespace osteomill {

enum class ColumnType : unsigned char { real, integer, small_integer };

/// One column of recordings and logs: how it is called and where in a record its number stands.
struct RecordColumn {
  const char* name;
  /// Empty for a pure number.
  const char* unit;
  /// In a few words, with the frame.
  const char* meaning;
  ColumnType type;
  /// Whether the CSV log has it (recordings have all).
  bool in_log;
  double (*get)(const TickRecord&);
  void (*set)(TickRecord&, double);
};

/// All columns, those of the CSV log in its order.
std::span<const RecordColumn> record_columns();

/// Writes the CSV log: a header and a row a tick, `time_s` first and `compute_us` last. Numbers are the
/// shortest that read back to the same double, with a point whatever the locale. Appears whole or not at all;
/// throws InputError, naming the file, where it cannot be written.
void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records);

}  // namespace osteomill
