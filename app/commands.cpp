#include "app/commands.h"

namespace osteomill::app {

void add_commands(CLI::App& program) {
  add_compare_command(program);
  add_rates_command(program);
  add_info_command(program);
  add_report_command(program);
}

}  // namespace osteomill::app
