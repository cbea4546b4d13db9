#pragma once

#include <filesystem>

#include "osteomill/experiment/study.h"
#include "osteomill/report/figure.h"

namespace osteomill {

/// A dot for every seed, by algorithm and mode, with a bar at their median: a panel for each key metric that
/// is not zero throughout, at most eight.
Figure draw_study_figure(const Study& study, std::string_view phase, const std::filesystem::path& folder);

}  // namespace osteomill
