#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"
#include "osteomill/base/run_program.h"
#include "osteomill/base/signal_cleanup.h"
#include "osteomill/base/work_progress.h"
#include "osteomill/live/crash_stop.h"

#include "app/commands.h"
#include "app/memory_limit.h"
#include "app/option_checks.h"
#include "app/progress.h"

namespace {

constexpr int kSuccess = 0;
constexpr int kBadInput = 1;
constexpr int kWrongUsage = 2;

int report_error(const char* reason, int code) {
  osteomill::app::print_error(fmt::format("osteomill: {}\n", osteomill::in_one_line(reason)));
  return code;
}

// Prevents that a file opened later gets the descriptor of a closed standard stream and receives messages.
void open_closed_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDWR);
}

// Flushes standard output, and returns an error's exit code if that or an earlier write failed.
int end_output(int code) {
  if (code != kSuccess || (std::fflush(stdout) == 0 && std::ferror(stdout) == 0)) return code;
  return report_error(osteomill::with_reason("standard output: cannot be written").c_str(), kBadInput);
}

// Returns the call as it would be typed into a shell, with "osteomill" as the program.
std::string command_line_of(int argc, const char* const* argv) {
  std::string line = "osteomill";
  for (int n = 1; n < argc; ++n) line += " " + osteomill::quoted(argv[n]);
  return line;
}

constexpr std::size_t kWidth = 80;
constexpr std::size_t kColumn = 28;

// Wraps text to kWidth. The first line starts at `column`; later lines are indented by `indent`.
std::string wrapped(const std::string& text, std::size_t column, std::size_t indent) {
  std::istringstream words(text);
  std::string lines, word;
  std::size_t at = column;
  while (words >> word) {
    if (at > column && at + 1 + word.size() > kWidth) {
      lines += "\n" + std::string(indent, ' ');
      at = column = indent;
    }
    lines += (at > column ? " " : "") + word;
    at += word.size() + (at > column ? 1 : 0);
  }
  return lines;
}

std::string entry(const std::string& name, const std::string& text) {
  std::string line = "  " + name;
  line +=
      line.size() + 2 > kColumn ? "\n" + std::string(kColumn, ' ') : std::string(kColumn - line.size(), ' ');
  return line + wrapped(text, kColumn, kColumn) + "\n";
}

constexpr const char* kLast = "Options";

// Help for a terminal of 80 columns: options in groups, general options last, values as a unit or one word,
// defaults in square brackets.
class HelpText : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override {
    return wrapped(app->get_description(), 0, 0) + "\n";
  }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
    std::vector<std::string> groups = app->get_groups();
    std::stable_partition(groups.begin(), groups.end(),
                          [](const std::string& group) { return group != kLast; });
    for (const std::string& group : groups) {
      const auto options = app->get_options(
          [&](const CLI::Option* option) { return option->get_group() == group && option->nonpositional(); });
      if (!options.empty()) text += make_group(group, false, options);
    }
    return text + make_subcommands(app, mode);
  }

  std::string make_subcommand(const CLI::App* command) const override {
    return entry(command->get_name(), command->get_description());
  }

  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string name = make_option_name(option, is_positional);
    // CLI11 adds the value of a switch's second name.
    if (const std::size_t value = name.find("{false}"); value != std::string::npos) name.erase(value, 7);
    if (is_positional) {
      name = option->get_expected_max() > 1 ? name + " ..." : name;
    } else if (option->get_type_size() != 0) {
      name += " " + option->get_type_name();
    }
    std::string text = option->get_description();
    if (option->get_required()) text += " (required)";
    if (!option->get_default_str().empty()) text += fmt::format(" [{}]", option->get_default_str());
    return entry(name, text);
  }
};

int run(int argc, char** argv, osteomill::app::WindowDriver* driver) {
  constexpr rlim_t kMinStackBytes = 256 * 1024;
  rlimit stack{};
  if (::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < kMinStackBytes) {
    return report_error("the stack is limited to less than 256 KB (ulimit -s), which is not enough",
                        kBadInput);
  }
  const std::unique_ptr<CLI::App> made = osteomill::app::make_program(command_line_of(argc, argv), driver);
  CLI::App& program = *made;
  const osteomill::WorkProgress watched([](double) { osteomill::app::check_memory_limit(); });
  try {
    osteomill::app::require_known_words(program, argc, argv);
    program.parse(argc, argv);
    if (program.get_subcommands().empty()) {
      return report_error("no command is given; osteomill --help lists them", kWrongUsage);
    }
    return kSuccess;
  } catch (const CLI::Success& help_or_version) {
    return program.exit(help_or_version);
  } catch (const CLI::RuntimeError& exit) {
    return exit.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return report_error(error.what(), kWrongUsage);
  } catch (const osteomill::InputError& error) {
    return report_error(error.what(), kBadInput);
  } catch (const std::invalid_argument& error) {
    return report_error(error.what(), kWrongUsage);
  } catch (const std::bad_alloc&) {
    return report_error(osteomill::app::out_of_memory_text().c_str(), kBadInput);
  } catch (const std::length_error&) {
    return report_error(osteomill::app::out_of_memory_text().c_str(), kBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    return report_error((error.path1().string() + ": " + error.code().message()).c_str(), kBadInput);
  } catch (const std::system_error& error) {
    // end_output reports it.
    if (std::ferror(stdout) != 0) return kSuccess;
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    return report_error(no_thread ? "no more threads can be started (ulimit -u)" : error.what(), kBadInput);
  } catch (const std::exception& error) {
    return report_error(error.what(), kBadInput);
  }
}

}  // namespace

std::unique_ptr<CLI::App> osteomill::app::make_program(const std::string& command_line,
                                                       WindowDriver* driver) {
  auto program = std::make_unique<CLI::App>(
      "6-DOF haptic bone milling in CT scans, and measurements of haptic algorithms", "osteomill");
  program->set_version_flag("--version", OSTEOMILL_VERSION);
  program->formatter(std::make_shared<HelpText>());
  program->get_formatter()->label("SUBCOMMAND", "COMMAND");
  add_simulate_command(*program, command_line, driver);
  add_compare_command(*program, command_line);
  add_live_command(*program, command_line);
  add_rates_command(*program);
  add_replay_command(*program, command_line);
  add_info_command(*program);
  add_mesh_command(*program);
  add_save_command(*program);
  add_devices_command(*program);
  add_settings_command(*program);
  add_report_command(*program);
  add_study_command(*program);
  add_exercise_command(*program);
  add_debrief_command(*program);
  for (CLI::App* command : program->get_subcommands({})) check_values(*command);
  return program;
}

int osteomill::app::run_osteomill(int argc, char** argv, WindowDriver* driver) {
  open_closed_streams();
  // Makes writes beyond a file size limit or to a closed pipe fail with an error, as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  const CrashStop crash_stop;
  install_signal_cleanup();
  const InputProtection input_protection;
  return end_output(run(argc, argv, driver));
}
