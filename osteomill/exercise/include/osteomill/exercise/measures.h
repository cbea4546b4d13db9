#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/exercise/attempt.h"

namespace osteomill {

/// One thing that is measured of an attempt.
struct Measure {
  /// The name in files: "target_removed_percent".
  std::string name;
  std::string unit;
  /// The definition in words, and the publication that it comes from or was asked for by; empty if it is
  /// plain geometry or time.
  std::string formula;
  std::string source;
  /// Returns the value; not a number if it could not be measured.
  std::function<double(const Attempt&)> value;
  /// Whether each no-go structure, or each step, has a value of its own, too.
  enum class Each : unsigned char { none, structure, step };
  Each each = Each::none;
  /// Returns the value of one of them, by its place among the exercise's.
  std::function<double(const Attempt&, std::size_t part)> value_at = {};
};

/// Returns the names of the parts of an exercise that have a value of this measure each: of structures, or
/// the numbers of steps from 1.
std::vector<std::string> parts_of(const Measure& measure, const Exercise& exercise);

/// Returns every measure, in the order in which people should read them.
const std::vector<Measure>& all_measures();

/// Returns the measure of this name; null if there is none.
const Measure* find_measure(std::string_view name);
/// Returns the names of all measures, in the same order.
std::vector<std::string> measure_names();

/// Returns all measures as a Markdown table, which docs/exercises.md has.
std::string measures_table();

/// A row of a debriefing.
struct MeasuredValue {
  /// The measure, and behind a dot the structure or step if it is of one: "no_go_contact_s.facial nerve".
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

/// Measures an attempt: a row for each measure, for each of its structures or steps, and for each further
/// item that limits it.
std::vector<MeasuredValue> measure_attempt(const Attempt& attempt);

/// Returns a row's values as CSV, in the order of `write_measured`.
std::string csv_row(const MeasuredValue& row);

/// Writes the rows as CSV with the columns measure,value,unit,limit,met,source. Throws InputError, naming the
/// file, if it cannot be written.
void write_measured(const std::filesystem::path& path, const std::vector<MeasuredValue>& rows);

/// Writes how target, bone outside and Dice coefficient went on over the session, as CSV. Throws as
/// `write_measured`.
void write_progress(const std::filesystem::path& path, const Attempt& attempt);

}  // namespace osteomill
