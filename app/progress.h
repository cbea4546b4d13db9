#pragma once

#include <string_view>

namespace osteomill::app {

/// One line on standard error that is written over as the work goes on; silent where standard error is no
/// terminal.
void show_progress(std::string_view what, double fraction_done);
/// Clears that line.
void end_progress();

}  // namespace osteomill::app
