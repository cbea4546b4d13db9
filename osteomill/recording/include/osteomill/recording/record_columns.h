#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// Flag of a TickRecord field: included in the CSV log (recordings have all fields).
inline constexpr unsigned kInLog = 1;
/// Flag of a TickRecord field: measured by a clock, so that it differs from run to run.
inline constexpr unsigned kMeasuredTime = 2;
/// Flag of a TickRecord field: may be NaN or infinite, such as a pose that the device did not deliver.
inline constexpr unsigned kMayBeNotFinite = 4;

/// Returns the columns of recordings; those of the CSV log are in its order.
template <>
const std::vector<Field<TickRecord>>& fields_of<TickRecord>();

/// Writes the CSV log: a header and one row per tick with the columns that have kInLog, in order
/// (docs/recordings.md). Writes the shortest text that reads back to the same double, with a decimal point in
/// any locale. Writes the file atomically; throws InputError, naming it, if it cannot be written.
void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records);

}  // namespace osteomill
