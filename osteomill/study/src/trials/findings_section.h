#pragma once

#include "osteomill/study/page.h"
#include "osteomill/study/study.h"

namespace osteomill {

/// Returns a table of the paper's findings by verdict: how many, and which; without rows if the study has no
/// runs that a finding needs.
Table verdicts_table(const Study& study);

/// Returns the report's section on the paper's findings, each tested on the study; empty if the study has no
/// runs that a finding needs.
Section findings_section(const Study& study);

}  // namespace osteomill
