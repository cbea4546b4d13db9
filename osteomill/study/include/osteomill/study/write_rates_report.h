#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/study/measure_rates.h"
#include "osteomill/study/vertex_search.h"

namespace osteomill {

/// Measurements of section 8.1.
struct MeasuredRates {
  std::vector<RateRow> rows;
  /// Empty if surface-points was not requested.
  std::vector<VertexSearchRow> vertices;
};

/// Writes `out_dir`/rates.csv, vertices.csv (only if vertices were searched), rates.html and
/// figures/rates.svg and .png; returns the path of rates.html. Columns of rates.csv: algorithm, resolution,
/// points, step_us_median, step_us_p99, rate_hz, steps_per_s, paper_rate_hz (empty if the paper has none),
/// paced_rate_hz; of vertices.csv: the fields of VertexSearchRow. Each file is written atomically, the tables
/// even if no figure can be drawn. Throws InputError if there are no rows, a rate is not positive, gnuplot is
/// missing or fails, or a file cannot be written.
std::filesystem::path write_rates_report(const MeasuredRates& measured, const std::filesystem::path& out_dir);

}  // namespace osteomill
