#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "osteomill/study/figure.h"
#include "osteomill/study/html.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// A dot for every seed, by algorithm, with a bar at their median: a panel for each key metric that
/// is not zero throughout, at most eight.
Figure draw_study_figure(const Study& study, std::string_view phase, const std::filesystem::path& folder);

/// The report's section on a study: medians with their intervals, and which differences between algorithms
/// are significant.
PageSection study_section(const Study& study, const std::vector<CaptionedFigure>& figures);

/// The report's section on what the paper says it found, each held against the study.
PageSection findings_section(const Study& study);

}  // namespace osteomill
