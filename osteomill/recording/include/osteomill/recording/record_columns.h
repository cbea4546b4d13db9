#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "osteomill/base/field.h"
#include "osteomill/session/tick_record.h"

namespace osteomill {

/// A flag of the fields of a TickRecord: the CSV log has it (recordings have all).
inline constexpr unsigned kInLog = 1;
/// A flag of the fields of a TickRecord: a clock measured it, so that it differs from run to run.
inline constexpr unsigned kMeasuredTime = 2;
/// A flag of the fields of a TickRecord: it is not finite if the device gave no pose.
inline constexpr unsigned kMayBeNotFinite = 4;

/// Returns the columns of recordings and logs, those of the CSV log in its order.
template <>
const std::vector<Field<TickRecord>>& fields_of<TickRecord>();

/// Writes the CSV log: a header and a row a tick, of the columns that have kInLog, in their order
/// (docs/recordings.md). Numbers are the shortest that read back to the same double, with a point whatever
/// the locale. Appears whole or not at all; throws InputError, naming the file, if it cannot be written.
void write_csv(const std::filesystem::path& path, std::span<const TickRecord> records);

}  // namespace osteomill
