#pragma once

#include "osteomill/experiment/study.h"
#include "osteomill/report/html.h"

namespace osteomill {

/// The report's section on what the paper says it found, each held against the study, mode by mode.
PageSection findings_section(const Study& study);

}  // namespace osteomill
