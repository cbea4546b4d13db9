#pragma once

#include <CLI/App.hpp>

namespace osteomill::app {

/// Adds every command to the program; each runs when the command line has been parsed.
void add_commands(CLI::App& program);

void add_compare_command(CLI::App& program);
void add_info_command(CLI::App& program);
void add_rates_command(CLI::App& program);
void add_report_command(CLI::App& program);

}  // namespace osteomill::app
