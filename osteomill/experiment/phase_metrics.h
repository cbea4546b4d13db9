#pragma once

#include "osteomill/report/metrics.h"

namespace osteomill {

/// The figures of a phase of section 8.2 (run_metrics, which says what it throws), measured so that phases
/// can be compared: of a holding, the time for which it was to be held, without what the hand took longer to
/// come to that (counted_from_s says from when); and nothing that is felt where the tool lost contact and did
/// not find it again.
RunMetrics phase_metrics(const Recording& recording);

}  // namespace osteomill
