#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/exercise/attempt.h"

namespace osteomill {

/// A quantity measured on an attempt.
struct Measure {
  /// Name in files: "target_removed_percent".
  std::string name;
  std::string unit;
  /// Definition, and the publication that it comes from or that asks for it; empty if it is plain geometry or
  /// time.
  std::string formula;
  std::string source;
  /// Returns the value; NaN if it could not be measured.
  std::function<double(const Attempt&)> value;
  /// Whether each no-go structure, or each step, also has its own value.
  enum class Each : unsigned char { none, structure, step };
  Each each = Each::none;
  /// Returns the value for one of them, by its index in the exercise.
  std::function<double(const Attempt&, std::size_t part)> value_at = {};
};

/// Returns the names of an exercise's parts that have their own value of this measure: structures, or step
/// numbers from 1.
std::vector<std::string> parts_of(const Measure& measure, const Exercise& exercise);

/// Returns every measure, in reading order.
const std::vector<Measure>& all_measures();

/// Returns the measure of this name; null if there is none.
const Measure* find_measure(std::string_view name);
/// Returns the names of all measures, in the same order.
std::vector<std::string> measure_names();

/// Returns all measures as the Markdown table of docs/exercises.md.
std::string measures_table();

/// A row of a debriefing.
struct MeasuredValue {
  /// Measure, followed by a dot and the structure or step if it has one: "no_go_contact_s.facial nerve".
  std::string measure;
  /// Nothing if it could not be measured.
  std::optional<double> value;
  std::string unit;
  /// "at least 95"; empty if the exercise sets no limit.
  std::string limit;
  /// Nothing without a limit or a value.
  std::optional<bool> is_met;
  std::string source;
};

/// Measures an attempt. Returns a row for each measure, for each of its structures or steps, and for each
/// further item that limits it.
std::vector<MeasuredValue> measure_attempt(const Attempt& attempt);

/// Returns a row's values as CSV, in the column order of `write_measured`.
std::string csv_row(const MeasuredValue& row);

/// Writes rows as CSV with the columns measure,value,unit,limit,met,source. Throws InputError, naming the
/// file, if it cannot be written.
void write_measured(const std::filesystem::path& path, const std::vector<MeasuredValue>& rows);

/// Writes the target removed, the bone removed outside and the Dice coefficient over time as CSV. Throws as
/// `write_measured`.
void write_progress(const std::filesystem::path& path, const Attempt& attempt);

}  // namespace osteomill
