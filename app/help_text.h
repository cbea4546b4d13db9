#pragma once

#include <string>

#include <CLI/Formatter.hpp>

namespace osteomill::app {

/// Help for a terminal of 80 columns: options in their groups, those of the program itself last, descriptions
/// wrapped, what an option takes as a unit or in one word, and what it is without being given in brackets.
class HelpText : public CLI::Formatter {
 public:
  std::string make_description(const CLI::App* app) const override;
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_subcommand(const CLI::App* command) const override;
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
};

}  // namespace osteomill::app
