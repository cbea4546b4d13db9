#include "app/progress.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include <fmt/core.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"

namespace osteomill::app {

namespace {

using Clock = std::chrono::steady_clock;

bool quiet = false;

bool is_on_terminal() {
  static const bool terminal = ::isatty(STDERR_FILENO) == 1;
  return terminal;
}

struct Work {
  std::string what;
  Clock::time_point start;
  double fraction_done = 0;
  int tenths_printed = 0;
};
Work work;

std::string time_text(double seconds) {
  const long whole = std::lround(seconds);
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace

void add_quiet_option(CLI::App& command) {
  command
      .add_flag_function(
          "--quiet", [](std::int64_t) { quiet = true; },
          "Print only errors and no-go contacts on standard error")
      ->group("Options");
}

void show_progress(std::string_view what, double fraction_done) {
  constexpr double kSilent_s = 1;
  if (quiet) return;
  const Clock::time_point now = Clock::now();
  if (what != work.what || fraction_done < work.fraction_done) work = {std::string(what), now, 0, 0};
  work.fraction_done = fraction_done;
  const double passed_s = std::chrono::duration<double>(now - work.start).count();
  if (!(fraction_done > 0) || passed_s < kSilent_s) return;
  const std::string line = fmt::format("{} {:3.0f} %, {} left", what, 100 * fraction_done,
                                       time_text(passed_s * (1 - fraction_done) / fraction_done));
  if (is_on_terminal()) {
    print_error("\r\033[K" + line);
  } else if (const int tenths = static_cast<int>(10 * fraction_done + 1e-9); tenths > work.tenths_printed) {
    work.tenths_printed = tenths;
    print_error(line + "\n");
  }
}

void end_progress() {
  work = {};
  if (quiet || !is_on_terminal()) return;
  print_error("\r\033[K");
}

void print_error(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void warn(std::string_view line) {
  if (!quiet) warn_always(line);
}

void print_tables(const std::vector<Table>& tables) {
  if (quiet) return;
  for (const Table& table : tables) print_error(plain_text(table) + "\n");
}

void warn_always(std::string_view line) {
  if (is_on_terminal()) print_error("\r\033[K");
  print_error(fmt::format("osteomill: warning: {}\n", in_one_line(line)));
}

RunEvents events_on_terminal() {
  return {show_progress, warn, warn_always};
}

}  // namespace osteomill::app
