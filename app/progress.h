#pragma once

#include <string_view>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/study/page.h"
#include "osteomill/study/run_events.h"

namespace osteomill::app {

/// Adds --quiet: nothing but errors and no-go contacts on standard error.
void add_quiet_option(CLI::App& command);

/// Says on standard error how far the work `what` is and how long it still takes: on a terminal in one line
/// that is written over, else in a line each tenth. Silent in the work's first second. From one thread at a
/// time.
void show_progress(std::string_view what, double fraction_done);
/// The work is done: clears the line on a terminal.
void end_progress();

/// Writes to standard error. What cannot be written is dropped: it is no reason to end.
void say(std::string_view text);

/// A warning: one line on standard error, which --quiet silences.
void warn(std::string_view line);

/// Writes tables to standard error, unless --quiet.
void say_tables(const std::vector<Table>& tables);

/// A warning that --quiet does not silence: a burr that has come into a no-go structure, a recording that
/// cannot go on.
void warn_though_quiet(std::string_view line);

/// Progress and warnings as above.
RunEvents events_on_terminal();

}  // namespace osteomill::app
