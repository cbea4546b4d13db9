#include "app/commands.h"

namespace osteomill::app {

void add_commands(CLI::App& program, const std::string& command_line) {
  add_simulate_command(program, command_line);
  add_compare_command(program, command_line);
  add_live_command(program, command_line);
  add_rates_command(program);
  add_replay_command(program, command_line);
  add_info_command(program);
  add_mesh_command(program);
  add_save_command(program);
  add_devices_command(program);
  add_settings_command(program);
  add_report_command(program);
}

}  // namespace osteomill::app
