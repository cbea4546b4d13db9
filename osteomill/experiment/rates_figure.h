#pragma once

#include <filesystem>
#include <span>

#include "osteomill/experiment/rate_row.h"
#include "osteomill/report/figure.h"

namespace osteomill {

/// Rate against resolution, a panel for each algorithm, measured and from the paper, with the 1000 Hz that a
/// haptic loop needs.
Figure draw_rates_figure(std::span<const RateRow> rows, const std::filesystem::path& folder);

}  // namespace osteomill
