#pragma once

#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Returns the report's section on a study over several hands: medians with their intervals, and which
/// differences between algorithms are significant.
Section hands_section(const Study& study, const std::vector<CaptionedFigure>& figures);

/// Returns the report's section on holdings of all algorithms in one hole, which `study` has alone.
Section one_hole_section(const Study& study);

}  // namespace osteomill
