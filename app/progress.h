#pragma once

#include <string_view>

#include "osteomill/experiment/run_events.h"
#include "osteomill/session/fault_count.h"

namespace osteomill::app {

/// One line on standard error that is written over as the work goes on; silent where standard error is no
/// terminal.
void show_progress(std::string_view what, double fraction_done);
/// Clears that line.
void end_progress();

/// Progress as above, and warnings as one line each on standard error.
RunEvents events_on_terminal();

/// One line on standard error, beginning with `who`, where any wrench could not be sent as it was.
void print_faults(std::string_view who, const FaultCount& faults);

}  // namespace osteomill::app
