#pragma once

#include <string>

#include "osteomill/study/metrics.h"

namespace osteomill {

/// Returns what a field is, with its unit: "force above 20 Hz, rms (N)".
std::string with_unit(const std::string& text, const std::string& unit);
inline std::string label_of(const FieldDescription& field) {
  return with_unit(field.doc, field.unit);
}

/// The head of summary.csv, and a row of it, without line ends.
std::string summary_columns();
std::string summary_fields(const MeasuredRun& run);

/// Returns a field of CSV behind a comma; empty if it is not a number.
std::string csv_number(double value);

}  // namespace osteomill
