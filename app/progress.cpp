#include "app/progress.h"

#include <cstdio>

#include <fmt/core.h>
#include <unistd.h>

namespace osteomill::app {

namespace {

bool on_terminal() {
  static const bool terminal = ::isatty(STDERR_FILENO) == 1;
  return terminal;
}

}  // namespace

void show_progress(std::string_view what, double fraction_done) {
  if (!on_terminal()) return;
  fmt::print(stderr, "\r\033[K{} {:3.0f} %", what, 100 * fraction_done);
  std::fflush(stderr);
}

void end_progress() {
  if (!on_terminal()) return;
  fmt::print(stderr, "\r\033[K");
  std::fflush(stderr);
}

RunEvents events_on_terminal() {
  return {show_progress, [](const std::string& line) {
            end_progress();
            fmt::print(stderr, "osteomill: {}\n", line);
          }};
}

void print_faults(std::string_view who, const FaultCount& faults) {
  if (const auto said = faults.sentence()) fmt::print(stderr, "osteomill: {}: {}\n", who, *said);
}

}  // namespace osteomill::app
