#include "app/help_text.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Option.hpp>
#include <fmt/core.h>

namespace osteomill::app {

namespace {

constexpr std::size_t kWidth = 80;
constexpr std::size_t kColumn = 28;

// Words put into lines, each but the first after `indent` blanks; the first has room from `column` on.
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

}  // namespace

std::string HelpText::make_description(const CLI::App* app) const {
  return wrapped(app->get_description(), 0, 0) + "\n";
}

std::string HelpText::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
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

std::string HelpText::make_subcommand(const CLI::App* command) const {
  return entry(command->get_name(), command->get_description());
}

std::string HelpText::make_option(const CLI::Option* option, bool is_positional) const {
  std::string name = make_option_name(option, is_positional);
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

}  // namespace osteomill::app
