#pragma once

#include <span>
#include <string>
#include <vector>

#include "osteomill/report/metrics.h"

namespace osteomill {

/// The tables of a report's page, in their order; `rate` ends that of the times.
enum class MetricTable : unsigned char { none, force, torque, shaft, path, times, rate };

/// One figure of a run, and all that is said of it wherever it is shown.
struct Metric {
  /// Of summary.csv, whose columns are in the order of `all_metrics`; empty for none.
  const char* column;
  /// Empty for a pure number.
  const char* unit;
  double& (*place)(RunMetrics&);
  MetricTable table = MetricTable::none;
  /// In that table.
  const char* label = "";
  /// There, as fmt takes it.
  const char* format = "{:.4g}";
  /// Its place among what studies compare, in the order in which people should read that, from 1; 0 where
  /// they do not.
  int compared = 0;
  /// As studies call it.
  const char* name = "";
  /// Of unrest in the hand, and of time.
  bool less_is_better = false;

  /// Not a number where it could not be measured.
  double operator()(RunMetrics run) const { return place(run); }
};

/// Every figure that is shown anywhere, and the columns of summary.csv among them.
std::span<const Metric> all_metrics();
const std::vector<Metric>& summary_metrics();

/// "force above 20 Hz, rms (N)".
std::string with_unit(const char* text, const Metric& metric);

/// The head of summary.csv, and a row of it, without line ends.
std::string summary_columns();
std::string summary_fields(const MeasuredRun& run);

/// A field of CSV behind a comma; empty where it is not a number.
std::string csv_number(double value);

}  // namespace osteomill
