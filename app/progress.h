#pragma once

#include <string_view>

#include <CLI/App.hpp>

#include "osteomill/experiment/run_events.h"

namespace osteomill::app {

/// Adds --quiet: nothing but errors and no-go contacts on standard error.
void add_quiet_option(CLI::App& command);

/// How far the work `what` is, and how long it still takes, on standard error: on a terminal one line that is
/// written over, else a line each tenth. Silent in the work's first second. From one thread at a time.
void show_progress(std::string_view what, double fraction_done);
/// The work is done: clears the line on a terminal.
void end_progress();

/// One line on standard error that names what it is about and does not forbid going on.
void warn(std::string_view line);

/// The same of what was asked for, which --quiet does not silence: a burr that has come into a no-go
/// structure, a recording that cannot go on.
void warn_though_quiet(std::string_view line);

/// Progress and warnings as above.
RunEvents events_on_terminal();

}  // namespace osteomill::app
