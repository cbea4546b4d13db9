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

ProgressText progress;

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

std::string ProgressText::at(std::string_view what, double fraction_done, double now_s) {
  constexpr double kSilent_s = 1;
  if (what != what_ || fraction_done < fraction_done_) {
    *this = {};
    what_ = what;
    start_s_ = line_s_ = now_s;
  }
  fraction_done_ = fraction_done;
  now_s_ = now_s;
  const double passed_s = now_s - start_s_;
  if (!(fraction_done > 0) || passed_s < kSilent_s) return {};
  return fmt::format("{} {:3.0f} %, {} left", what, 100 * fraction_done,
                     time_text(passed_s * (1 - fraction_done) / fraction_done));
}

bool ProgressText::claim_line() {
  constexpr double kMaxSilence_s = 60;
  const int tenths = static_cast<int>(10 * fraction_done_ + 1e-9);
  if (tenths <= tenths_written_ && now_s_ - line_s_ < kMaxSilence_s) return false;
  tenths_written_ = tenths;
  line_s_ = now_s_;
  return true;
}

void show_progress(std::string_view what, double fraction_done) {
  if (quiet) return;
  const double now_s = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
  const std::string text = progress.at(what, fraction_done, now_s);
  if (text.empty()) return;
  if (is_on_terminal()) {
    print_error("\r\033[K" + text);
  } else if (progress.claim_line()) {
    print_error(text + "\n");
  }
}

void end_progress() {
  progress = {};
  if (quiet || !is_on_terminal()) return;
  print_error("\r\033[K");
}

void print_error(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
}

void warn(std::string_view line) {
  if (!quiet) warn_despite_quiet(line);
}

void print_tables(const std::vector<Table>& tables) {
  if (quiet) return;
  for (const Table& table : tables) print_error(plain_text(table) + "\n");
}

void warn_despite_quiet(std::string_view line) {
  if (is_on_terminal()) print_error("\r\033[K");
  print_error(fmt::format("osteomill: warning: {}\n", in_one_line(line)));
}

RunEvents events_on_terminal() {
  return {show_progress, warn, warn_despite_quiet};
}

}  // namespace osteomill::app
