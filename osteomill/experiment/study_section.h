#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "osteomill/experiment/study.h"
#include "osteomill/report/figure.h"
#include "osteomill/report/html.h"

namespace osteomill {

/// A dot for every seed, by algorithm and mode, with a bar at their median: a panel for each key metric that
/// is not zero throughout, at most eight.
Figure draw_study_figure(const Study& study, std::string_view phase, const std::filesystem::path& folder);

/// The report's section on a study: medians with their intervals, which differences between algorithms are
/// significant, and what `steady` changes.
PageSection study_section(const Study& study, const std::vector<CaptionedFigure>& figures);

/// The report's section on what the paper says it found, each held against the study, mode by mode.
PageSection findings_section(const Study& study);

}  // namespace osteomill
