#pragma once

#include <filesystem>
#include <span>

#include "osteomill/experiment/measure_passivity.h"
#include "osteomill/report/figure.h"

namespace osteomill {

/// The stiffness felt at the limit over the device's damping, a panel for each delay and mode, with the rule
/// of the ideal wall.
Figure draw_passivity_figure(std::span<const PassivityRow> rows, const std::filesystem::path& folder);

}  // namespace osteomill
