#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/experiment/rate_row.h"

namespace osteomill {

/// Writes `out_dir`/rates.csv, rates.html and figures/rates.svg and .png; returns the path of rates.html.
/// Columns of rates.csv: algorithm, resolution, points, step_us_median, step_us_p99, rate_hz, steps_per_s,
/// paper_rate_hz (empty where the paper has none). Files appear whole, the page last. Throws InputError where
/// there are no rows, a rate is not positive, gnuplot is missing or fails, or a file cannot be written.
std::filesystem::path write_rates_report(const std::vector<RateRow>& rows,
                                         const std::filesystem::path& out_dir);

}  // namespace osteomill
