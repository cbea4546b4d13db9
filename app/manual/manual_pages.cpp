#include "app/manual/manual_pages.h"

#include <cctype>
#include <string_view>

#include <CLI/StringTools.hpp>
#include <fmt/format.h>

namespace osteomill::app {

namespace {

// Returns the next code point of UTF-8 text and advances `at` past it.
unsigned next_code_point(std::string_view text, std::size_t& at) {
  const auto byte = [&] { return static_cast<unsigned char>(text[at++]); };
  const unsigned first = byte();
  if (first < 0x80) return first;
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
  unsigned code = first & (0x3Fu >> more);
  for (int n = 0; n < more && at < text.size(); ++n) code = code << 6 | (byte() & 0x3Fu);
  return code;
}

// Escapes text for roff, with plain ASCII hyphens and other characters by code point.
std::string roff(std::string_view text) {
  std::string out;
  if (text.starts_with('.') || text.starts_with('\'')) out = "\\&";
  for (std::size_t at = 0; at < text.size();) {
    const unsigned code = next_code_point(text, at);
    if (code >= 0x80) {
      out += fmt::format("\\[u{:04X}]", code);
    } else if (code == '-') {
      out += "\\-";
    } else if (code == '\\') {
      out += "\\e";
    } else if (code == '\'') {
      out += "\\(aq";
    } else {
      out += static_cast<char>(code);
    }
  }
  return out;
}

std::string sentence(const std::string& text) {
  return roff(text) + (text.ends_with('.') ? "\n" : ".\n");
}

std::string head(const std::string& page, const std::string& summary, const Edition& edition) {
  std::string title = page;
  for (char& c : title) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return fmt::format(".TH {} 1 {} \"osteomill {}\" \"User Commands\"\n.nh\n.SH NAME\n{} \\- {}\n",
                     roff(title), edition.date, edition.version, roff(page), roff(summary));
}

std::string option_entry(const OptionText& option) {
  std::string names;
  for (const std::string& name : option.names)
    names += (names.empty() ? "" : ", ") + fmt::format("\\fB{}\\fR", roff(name));
  if (!option.value.empty() && option.value != option.names.front())
    names += fmt::format(" \\fI{}\\fR", roff(option.value));
  std::string text = ".TP\n" + names + "\n" + sentence(option.description);
  if (option.is_required) text += "Required.\n";
  if (!option.default_value.empty()) text += "Default: " + roff(option.default_value) + "\n";
  return text;
}

// Formats each group of options under its own heading.
std::string option_section(const std::vector<OptionText>& options) {
  std::string text = ".SH OPTIONS\n";
  const std::vector<std::string> groups = groups_of(options);
  for (const std::string& group : groups) {
    if (groups.size() > 1) text += fmt::format(".SS {}\n", roff(group));
    for (const OptionText& option : options)
      if (option.group == group) text += option_entry(option);
  }
  return text;
}

constexpr std::string_view kExitStatus = R"(.SH EXIT STATUS
.TP
0
Success.
.TP
1
Invalid input: a file, a device or a system limit. Standard error has one line with the reason.
.TP
2
Invalid command line.
)";

constexpr std::string_view kEnvironment = R"(.SH ENVIRONMENT
.TP
\fBOSTEOMILL_DHD_LIBRARY\fR, \fBOSTEOMILL_HD_LIBRARY\fR
Paths of the device vendors\(aq libraries, libdhd of Force Dimension and libHD of 3D Systems, if the system does not find them by name.
.TP
\fBSPNAV_SOCKET\fR
Socket of the daemon spacenavd, which a SpaceMouse needs.
.SH FILES
.TP
\fI$XDG_CONFIG_HOME/osteomill/devices/NAME.toml\fR
Workspace settings of a haptic device (\fI~/.config\fR if the variable is not set).
.TP
\fI$XDG_STATE_HOME/osteomill/\fR
Autosaved copies of milled bone, and whether the window has explained its controls (\fI~/.local/state\fR if the variable is not set).
)";

}  // namespace

std::string program_page(const std::vector<CommandText>& program_and_commands, const Edition& edition) {
  const CommandText& program = program_and_commands.front();
  const std::vector<CommandText> commands(program_and_commands.begin() + 1, program_and_commands.end());
  std::string text = head(program.name, program.description, edition);
  text +=
      ".SH SYNOPSIS\n\\fBosteomill\\fR \\fICOMMAND\\fR [\\fIARGUMENTS\\fR]\n.br\n\\fBosteomill\\fR "
      "\\fB\\-\\-help\\fR | \\fB\\-\\-version\\fR\n.SH DESCRIPTION\n";
  text +=
      "osteomill mills bone with a haptic device, a mouse or a simulated hand: a CT scan in, force and "
      "torque out "
      "at 1000 Hz.\nEach command has its own page, \\fBosteomill\\-\\fICOMMAND\\fR(1), and "
      "\\fB\\-\\-help\\fR.\n"
      "Research software, not a medical device.\n.SH COMMANDS\n";
  std::string see_also;
  for (const std::string& group : groups_of(commands)) {
    text += fmt::format(".SS {}\n", roff(group));
    for (const CommandText& command : commands) {
      if (command.group != group) continue;
      text += fmt::format(".TP\n\\fB{}\\fR\n{}", roff(command.name), sentence(command.description));
      see_also += fmt::format("{}.BR osteomill\\-{} (1)", see_also.empty() ? "" : " ,\n", roff(command.name));
    }
  }
  text += option_section(program.options);
  text += kExitStatus;
  text += kEnvironment;
  return text + ".SH SEE ALSO\n" + see_also + "\n";
}

std::string command_page(const CommandText& command, const Edition& edition) {
  std::string text = head("osteomill-" + command.name, command.description, edition);
  text += fmt::format(".SH SYNOPSIS\n\\fBosteomill {}\\fR [\\fIOPTION\\fR ...]", roff(command.name));
  for (const OptionText& argument : command.arguments) {
    const std::string name =
        fmt::format("\\fI{}\\fR{}", roff(argument.names.front()), argument.may_repeat ? " ..." : "");
    text += argument.is_required ? " " + name : " [" + name + "]";
  }
  text += "\n.SH DESCRIPTION\n" + sentence(command.description);
  for (const OptionText& argument : command.arguments) text += option_entry(argument);
  text += option_section(command.options);
  text += kExitStatus;
  return text + ".SH SEE ALSO\n.BR osteomill (1)\n";
}

}  // namespace osteomill::app
