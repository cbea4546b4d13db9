#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "osteomill/study/metrics.h"
#include "osteomill/study/page.h"

namespace osteomill {

/// Returns a text followed by its unit: "force above 20 Hz, rms (N)".
std::string with_unit(const std::string& text, const std::string& unit);
/// Returns a field's description with its unit.
inline std::string label_of(const FieldDescription& field) {
  return with_unit(field.doc, field.unit);
}

/// Returns the header of summary.csv, without a line end.
std::string summary_columns();
/// Returns a run's row of summary.csv, without a line end.
std::string summary_fields(const MeasuredRun& run);

/// Returns the names of fields for a CSV header, each preceded by a comma.
template <typename Struct>
std::string csv_names(const std::vector<Field<Struct>>& fields) {
  std::string names;
  for (const Field<Struct>& metric : fields) names += "," + metric.name;
  return names;
}
/// Returns a number as a CSV field, preceded by a comma; the field is empty for NaN.
std::string csv_value(double value);
/// Returns the values of the fields of `s` for a CSV row, each as `csv_value`.
template <typename Struct>
std::string csv_values(const std::vector<Field<Struct>>& fields, const Struct& s) {
  std::string values;
  for (const Field<Struct>& metric : fields) values += csv_value(metric.get(s));
  return values;
}

/// Returns a table of rows: first the columns of `header`, with cells from `named`, then a column for each
/// field that is a number in at least one row.
template <typename Row, typename Named>
Table table_of(const std::vector<Row>& rows, const std::vector<std::string>& header, const Named& named) {
  Table table{header, {}, true};
  for (const Row& row : rows) table.rows.push_back(named(row));
  for (const Field<Row>& metric : fields_of<Row>()) {
    const auto lacks = [&](const Row& row) { return std::isnan(metric.get(row)); };
    if (std::ranges::all_of(rows, lacks)) continue;
    table.header.push_back(label_of(metric));
    for (std::size_t n = 0; n < rows.size(); ++n) table.rows[n].emplace_back(shown(metric.get(rows[n])));
  }
  return table;
}

}  // namespace osteomill
