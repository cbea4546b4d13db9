#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/study/page.h"
#include "osteomill/study/run_events.h"

namespace osteomill::app {

/// Adds --quiet: nothing but errors and no-go contacts on standard error.
void add_quiet_option(CLI::App& command);

/// Words how far a piece of work is, and decides when that is worth a line.
class ProgressText {
 public:
  /// Notes that the work `what` is so far at a time of a clock in s. Less than before, or another work,
  /// begins again. Returns "compare  40 %, 12 s left"; empty in the work's first second.
  std::string at(std::string_view what, double fraction_done, double now_s);
  /// Returns whether the text last returned is worth a line that stays: at each tenth, and after a minute
  /// without one. Then counts it as written.
  bool take_line();

 private:
  std::string what_;
  double start_s_ = 0;
  double now_s_ = 0;
  double fraction_done_ = 0;
  double line_s_ = 0;
  int tenths_written_ = 0;
};

/// Says on standard error how far the work `what` is and how long it still takes: on a terminal in one line
/// that is written over, else in a line each tenth and at least each minute. Silent in the work's first
/// second. From one thread at a time.
void show_progress(std::string_view what, double fraction_done);
/// Clears the line on a terminal when the work is done.
void end_progress();

/// Writes to standard error. A text that cannot be written is dropped: that is no reason to end the program.
void print_error(std::string_view text);

/// Writes a warning, one line on standard error, which --quiet silences.
void warn(std::string_view line);

/// Writes tables to standard error, unless --quiet.
void print_tables(const std::vector<Table>& tables);

/// Writes a warning that --quiet does not silence: a burr that has come into a no-go structure, a recording
/// that cannot go on.
void warn_always(std::string_view line);

/// Returns events that report progress and warnings as the functions above do.
RunEvents events_on_terminal();

}  // namespace osteomill::app
