#pragma once

#include <filesystem>

#include "osteomill/report/figure.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {

/// The paper's figure 9: where the simulated tool's shaft points, as points on the unit sphere coloured by
/// time, a panel for each phase and algorithm. The panels of a phase have the same ranges, all three axes the
/// same scale.
Figure draw_shaft_figure(const RunGroup& group, const std::filesystem::path& folder);

}  // namespace osteomill
