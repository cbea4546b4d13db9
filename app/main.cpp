#include <csignal>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "app/commands.h"
#include "app/help_text.h"
#include "app/memory_limit.h"
#include "app/option_checks.h"
#include "app/progress.h"
#include "app/shell.h"
#include <CLI/CLI.hpp>
#include <fmt/core.h>
#include <sys/resource.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/input_files.h"
#include "osteomill/numbers/work_progress.h"

namespace {

constexpr int kDone = 0;
constexpr int kInputAtFault = 1;
constexpr int kWrongUsage = 2;

int complain(const char* reason, int code) {
  fmt::print(stderr, "osteomill: {}\n", osteomill::in_one_line(reason));
  return code;
}

// How the program was called, as it would be typed into a shell, the program as "osteomill".
std::string command_line_of(int argc, const char* const* argv) {
  std::string line = "osteomill";
  for (int n = 1; n < argc; ++n) line += " " + osteomill::app::quoted(argv[n]);
  return line;
}

}  // namespace

int main(int argc, char** argv) {
  constexpr rlim_t kLeastStackBytes = 256 * 1024;
  const osteomill::KeepInputs keep_inputs;
  // A file as long as a limit allows is then one that cannot be written, as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit stack{};
  if (::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < kLeastStackBytes) {
    return complain("the stack is limited to less than 256 KB (ulimit -s), which is not enough",
                    kInputAtFault);
  }
  CLI::App program("6-DOF haptic bone milling: haptic algorithms on a CT scan, measured", "osteomill");
  program.set_version_flag("--version", OSTEOMILL_VERSION);
  program.formatter(std::make_shared<osteomill::app::HelpText>());
  program.get_formatter()->label("SUBCOMMAND", "COMMAND");
  const std::string command_line = command_line_of(argc, argv);
  osteomill::app::add_simulate_command(program, command_line);
  osteomill::app::add_compare_command(program, command_line);
  osteomill::app::add_live_command(program, command_line);
  osteomill::app::add_rates_command(program);
  osteomill::app::add_replay_command(program, command_line);
  osteomill::app::add_info_command(program);
  osteomill::app::add_mesh_command(program);
  osteomill::app::add_save_command(program);
  osteomill::app::add_devices_command(program);
  osteomill::app::add_settings_command(program);
  osteomill::app::add_report_command(program);
  osteomill::app::add_study_command(program);
  const osteomill::WorkProgress watched([](double) { osteomill::app::check_memory_taken(); });
  try {
    osteomill::app::require_known_words(program, argc, argv);
    program.parse(argc, argv);
    if (program.get_subcommands().empty()) {
      return complain("no command is given; osteomill --help lists them", kWrongUsage);
    }
    return kDone;
  } catch (const CLI::CallForHelp& help) {
    return program.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return program.exit(version);
  } catch (const CLI::RuntimeError& said) {
    return said.get_exit_code();
  } catch (const CLI::ParseError& error) {
    return complain(error.what(), kWrongUsage);
  } catch (const osteomill::InputError& error) {
    return complain(error.what(), kInputAtFault);
  } catch (const std::invalid_argument& error) {
    return complain(error.what(), kWrongUsage);
  } catch (const std::bad_alloc&) {
    return complain(osteomill::app::out_of_memory_text().c_str(), kInputAtFault);
  } catch (const std::system_error& error) {
    const bool no_thread = error.code() == std::errc::resource_unavailable_try_again;
    return complain(no_thread ? "no more threads can be started (ulimit -u)" : error.what(), kInputAtFault);
  } catch (const std::exception& error) {
    return complain(error.what(), kInputAtFault);
  }
}
