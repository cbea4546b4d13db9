#pragma once

#include <filesystem>
#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Draws a figure for each phase, in which every seed is a dot, by algorithm, with a bar at their median: a
/// panel for each key metric that is not zero throughout, at most twelve.
std::vector<CaptionedFigure> draw_hands(const Study& study, const std::filesystem::path& folder);

}  // namespace osteomill
