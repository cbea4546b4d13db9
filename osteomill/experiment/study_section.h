#pragma once

#include <string>
#include <vector>

#include "osteomill/experiment/study.h"
#include "osteomill/report/report_page.h"

namespace osteomill {

/// The report's section on a study: medians with their intervals, which differences between algorithms are
/// significant, whether the paper's findings hold over the seeds, and what `steady` changes. HTML. Throws
/// InputError where a figure cannot be read.
std::string study_section(const Study& study, const std::vector<CaptionedFigure>& figures);

}  // namespace osteomill
