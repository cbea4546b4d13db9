#include "app/manual/completions.h"

#include <map>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace osteomill::app {

namespace {

constexpr std::string_view kWritten = "# Written from the command line of osteomill by osteomill_manual.\n";

// Escapes each character of `special` with a backslash.
std::string escaped(std::string_view text, std::string_view special) {
  std::string out;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

std::string joined(const std::vector<std::string>& words, std::string_view between = " ") {
  return fmt::format("{}", fmt::join(words, between));
}

std::vector<std::string> option_names(const CommandText& command) {
  std::vector<std::string> names;
  for (const OptionText& option : command.options)
    names.insert(names.end(), option.names.begin(), option.names.end());
  return names;
}

// Returns a text in single quotes for zsh.
std::string zsh_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// Returns ":mm:" or ":FILE:_files", which follows an option's description.
std::string zsh_value(const OptionText& option) {
  if (option.value.empty()) return "";
  std::string action;
  if (option.completion == Completion::kWords) action = "(" + joined(option.words) + ")";
  if (option.completion == Completion::kFile) action = "_files";
  if (option.completion == Completion::kFolder) action = "_files -/";
  return ":" + escaped(option.value, ":") + ":" + action;
}

std::vector<std::string> zsh_arguments(const CommandText& command) {
  std::vector<std::string> specs;
  for (const OptionText& option : command.options) {
    const std::string explained = "[" + escaped(option.description, "[]:\\") + "]" + zsh_value(option);
    for (const std::string& name : option.names)
      specs.push_back(zsh_quoted((option.may_repeat ? "*" : "") + name + explained));
  }
  for (const OptionText& argument : command.arguments)
    specs.push_back(zsh_quoted((argument.may_repeat ? "*" : "") + zsh_value(argument)));
  return specs;
}

// Returns the arguments for an option's values: "-x -a 'one two'".
std::string fish_value(const OptionText& option) {
  if (option.value.empty()) return "";
  if (option.completion == Completion::kWords) return fmt::format(" -x -a '{}'", joined(option.words));
  if (option.completion == Completion::kFile) return " -r -F";
  if (option.completion == Completion::kFolder) return " -x -a '(__fish_complete_directories)'";
  return " -x";
}

std::string fish_option(const std::string& condition, const OptionText& option) {
  std::string lines;
  for (const std::string& name : option.names) {
    const bool is_long = name.starts_with("--");
    lines +=
        fmt::format("complete -c osteomill -n '{}' -{} {}{} -d '{}'\n", condition, is_long ? 'l' : 's',
                    name.substr(is_long ? 2 : 1), fish_value(option), escaped(option.description, "'\\"));
  }
  return lines;
}

// Returns the shell code that completes the values of an option.
std::string bash_value(const OptionText& option) {
  if (option.completion == Completion::kWords) return fmt::format("words='{}'", joined(option.words));
  if (option.completion == Completion::kFile) return "kind=-f";
  if (option.completion == Completion::kFolder) return "kind=-d";
  return "return";
}

// Returns the cases of "COMMAND --OPTION"; a single case if an option takes the same values in every command.
std::string bash_value_cases(const std::vector<CommandText>& commands) {
  std::map<std::string, std::map<std::string, std::vector<std::string>>> commands_by_name_and_code;
  for (const CommandText& command : commands) {
    for (const OptionText& option : command.options) {
      if (option.value.empty()) continue;
      for (const std::string& name : option.names)
        commands_by_name_and_code[name][bash_value(option)].push_back(command.name);
    }
  }
  std::map<std::string, std::vector<std::string>> patterns_by_code;
  for (const auto& [name, commands_by_code] : commands_by_name_and_code) {
    for (const auto& [code, having_it] : commands_by_code) {
      std::vector<std::string>& patterns = patterns_by_code[code];
      if (commands_by_code.size() == 1) {
        patterns.push_back(fmt::format("*' {}'", name));
        continue;
      }
      for (const std::string& command : having_it) patterns.push_back(fmt::format("'{} {}'", command, name));
    }
  }
  std::string cases;
  for (const auto& [code, patterns] : patterns_by_code)
    cases += fmt::format("    {}) {} ;;\n", joined(patterns, " | "), code);
  return cases;
}

}  // namespace

std::string bash_completion(const std::vector<CommandText>& program_and_commands) {
  std::vector<std::string> names, with_arguments;
  std::string options;
  for (const CommandText& command : program_and_commands) {
    const bool is_program = &command == &program_and_commands.front();
    if (!is_program) names.push_back(command.name);
    options += fmt::format("            {}) words='{}' ;;\n", is_program ? "''" : command.name,
                           joined(option_names(command)));
    if (!command.arguments.empty()) with_arguments.push_back(command.name);
  }
  return std::string(kWritten) + R"(_osteomill() {
  local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command='' kind='' words=''
  [ "$COMP_CWORD" -lt 2 ] || command=${COMP_WORDS[1]}
  # "--option=value" comes in three words.
  if [ "$current" = = ]; then
    current=''
  elif [ "$previous" = = ]; then
    previous=${COMP_WORDS[COMP_CWORD - 2]}
  fi
  COMPREPLY=()
  case "$command $previous" in
)" + bash_value_cases(program_and_commands) +
         R"(    *)
      case $current in
        -*)
          case $command in
)" + options +
         R"(          esac
          ;;
        *)
          case $command in
            '') words=')" +
         joined(names) + R"(' ;;
            )" +
         joined(with_arguments, " | ") + R"() kind=-f ;;
          esac
          ;;
      esac
      ;;
  esac
  if [ -n "$kind" ]; then
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen "$kind" -- "$current")
  else
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}
complete -F _osteomill osteomill
)";
}

std::string zsh_completion(const std::vector<CommandText>& program_and_commands) {
  std::string commands, cases;
  for (std::size_t n = 1; n < program_and_commands.size(); ++n) {
    const CommandText& command = program_and_commands[n];
    commands += "    " + zsh_quoted(command.name + ":" + escaped(command.description, ":\\")) + "\n";
    cases += fmt::format("        {})\n          _arguments {} ;;\n", command.name,
                         joined(zsh_arguments(command), " \\\n            "));
  }
  return "#compdef osteomill\n" + std::string(kWritten) + R"(_osteomill() {
  local context state state_descr line
  typeset -A opt_args
  local -a commands=(
)" + commands +
         R"(  )
  _arguments -C )" +
         joined(zsh_arguments(program_and_commands.front()), " \\\n    ") + R"( \
    '1:command:->command' '*::argument:->arguments'
  case $state in
    command) _describe command commands ;;
    arguments)
      case $line[1] in
)" + cases +
         R"(      esac
      ;;
  esac
}
_osteomill "$@"
)";
}

std::string fish_completion(const std::vector<CommandText>& program_and_commands) {
  constexpr std::string_view kNoCommand = "__fish_use_subcommand";
  std::string text(kWritten);
  text += "complete -c osteomill -f\n";
  for (const CommandText& command : program_and_commands) {
    const bool is_program = &command == &program_and_commands.front();
    const std::string in_command =
        is_program ? std::string(kNoCommand) : "__fish_seen_subcommand_from " + command.name;
    if (!is_program) {
      text += fmt::format("complete -c osteomill -n '{}' -a {} -d '{}'\n", kNoCommand, command.name,
                          escaped(command.description, "'\\"));
    }
    if (!command.arguments.empty()) text += fmt::format("complete -c osteomill -n '{}' -F\n", in_command);
    for (const OptionText& option : command.options) text += fish_option(in_command, option);
  }
  return text;
}

}  // namespace osteomill::app
