#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Draws a figure for each phase: a panel for each key metric that is not zero throughout, at most twelve,
/// with a dot for each seed, by algorithm, and a bar at their median.
std::vector<CaptionedFigure> draw_hands(const Study& study, const std::filesystem::path& folder);

}  // namespace osteomill
