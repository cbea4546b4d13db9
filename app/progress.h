#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>

#include "osteomill/study/page.h"
#include "osteomill/study/run_events.h"

namespace osteomill::app {

/// Adds --quiet, which leaves only errors and no-go contacts on standard error.
void add_quiet_option(CLI::App& command);

/// Formats the progress of a task and decides when to print a line.
class ProgressText {
 public:
  /// Records the progress of the task `what` at `now_s`, a monotonic time. Restarts if the task changes or
  /// the fraction decreases. Returns "compare  40 %, 12 s left", or an empty text in the first second.
  std::string at(std::string_view what, double fraction_done, double now_s);
  /// Returns whether to print the text last returned as a permanent line: at each tenth, and after a minute
  /// without one. If so, counts it as printed.
  bool claim_line();

 private:
  std::string what_;
  double start_s_ = 0;
  double now_s_ = 0;
  double fraction_done_ = 0;
  double line_s_ = 0;
  int tenths_written_ = 0;
};

/// Prints the progress of the task `what` and the time left on standard error: on a terminal in one line that
/// is overwritten, otherwise in a new line at each tenth and at least each minute. Silent in the first
/// second. Call from one thread at a time.
void show_progress(std::string_view what, double fraction_done);
/// Ends the task; clears its line on a terminal.
void end_progress();

/// Writes to standard error and ignores write errors.
void print_error(std::string_view text);

/// Writes a warning as one line on standard error, unless --quiet.
void warn(std::string_view line);

/// Writes tables to standard error, unless --quiet.
void print_tables(const std::vector<Table>& tables);

/// Writes a warning even with --quiet, for example about a no-go contact or a failed recording.
void warn_despite_quiet(std::string_view line);

/// Returns events that call the functions above.
RunEvents events_on_terminal();

}  // namespace osteomill::app
