#pragma once

#include <filesystem>
#include <span>

#include "osteomill/session/tick_record.h"

namespace osteomill {

/// Writes the CSV log: a header and a row a tick, `time_s` first and `compute_us` last. Numbers are the
/// shortest that read back to the same double, with a point whatever the locale. Appears whole or not at all;
/// throws InputError, naming the file, where it cannot be written.
void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records);

}  // namespace osteomill
