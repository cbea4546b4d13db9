#pragma once

#include <vector>

#include "osteomill/study/page.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Returns the report's section on a study over several hands: medians with their intervals, and the
/// significant differences between algorithms.
Section hands_section(const Study& study, const std::vector<CaptionedFigure>& figures);

/// Returns the report's section on holds of all algorithms in the same hole; `study` contains only those.
Section one_hole_section(const Study& study);

}  // namespace osteomill
