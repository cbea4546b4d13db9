#pragma once

#include <memory>
#include <string>

#include <CLI/App.hpp>

namespace osteomill::app {

class WindowDriver;

/// Makes the command line: the program with every command. `command_line`, the program's call, is stored in
/// recordings. `driver`, if not null, operates the window of `simulate`.
std::unique_ptr<CLI::App> make_program(const std::string& command_line, WindowDriver* driver = nullptr);

/// Runs the program and returns its exit code. `driver`, if not null, operates the window of `simulate`.
int run_osteomill(int argc, char** argv, WindowDriver* driver = nullptr);

/// Each function adds a command to the program; the command runs once the command line is parsed.
void add_compare_command(CLI::App& program, const std::string& command_line);
void add_debrief_command(CLI::App& program);
void add_devices_command(CLI::App& program);
void add_exercise_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_live_command(CLI::App& program, const std::string& command_line);
void add_mesh_command(CLI::App& program);
void add_rates_command(CLI::App& program);
void add_replay_command(CLI::App& program, const std::string& command_line);
void add_report_command(CLI::App& program);
void add_save_command(CLI::App& program);
void add_settings_command(CLI::App& program);
void add_simulate_command(CLI::App& program, const std::string& command_line, WindowDriver* driver);
void add_study_command(CLI::App& program);

}  // namespace osteomill::app
