#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/App.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

#include "osteomill/base/field.h"

namespace osteomill::app {

/// Returns the end of a message about a word that is not known: "; did you mean point-shell?", or if none of
/// the known words is near and they are few, "; there are milling and wall", else nothing.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

/// Throws std::invalid_argument, "there is no algorithm x; did you mean ...", if `word` is none of `names`.
void require_word(const std::string& kind, const std::string& word, const std::vector<std::string>& names);
/// Makes a check that refuses a text that is none of `names`; `kind` says what they are ("algorithm").
CLI::Validator one_of(const std::string& kind, const std::vector<std::string>& names);
/// Makes a check remember the names that it takes, for choices_of.
CLI::Validator with_choices(CLI::Validator check, const std::vector<std::string>& names);
/// Returns the names that an option takes if its first check remembers them, as that of one_of does.
std::vector<std::string> choices_of(CLI::Option& option);

/// Returns a number as an option shows its default: "0.3".
std::string number_text(double value);

/// Returns the names of a command's options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command);

/// Throws CLI::ParseError if the command, or any option of it, is not known, naming it and the nearest that
/// is. Called before parsing, which would name a missing option first.
void require_known_words(const CLI::App& program, int argc, const char* const* argv);

/// Returns what is wrong with a text as a number of this range, "-1 is not a positive number"; empty for
/// nothing, and `value` is then the number.
std::string number_fault(const std::string& text, const NumberRange& range, double& value);
/// Returns the value of a number or a choice from its text. Throws std::invalid_argument, one line, if it is
/// none.
double value_of(const FieldDescription& field, const std::string& text);
/// Returns the value as an option shows it: a choice by its name.
std::string value_text(const FieldDescription& field, double value);
/// Makes a check that refuses a text that is not a number of this range.
CLI::Validator number_of(const NumberRange& range);
inline CLI::Validator positive_number() {
  return number_of(NumberRange::positive());
}

/// Adds an option for a number, or a switch that --no-NAME turns off.
void add_number(CLI::App& command, const FieldDescription& field, const std::string& shown_default,
                const std::function<void(double)>& take);
/// Adds every field of `s` that has an option, or those with one of `flags` (0: any), and shows each value as
/// its default.
template <typename Struct>
void add_fields(CLI::App& command, Struct& s, unsigned flags = 0, unsigned without_default = 0) {
  for (const Field<Struct>& field : fields_of<Struct>()) {
    if (field.option.empty() || (flags != 0 && !field.has(flags))) continue;
    add_number(command, field, field.has(without_default) ? "" : value_text(field, field.get(s)),
               [&s, &field](double value) { field.set(s, value); });
  }
}
/// Adds an option for a text that is not empty, or a list of them, which may repeat. `take` gets a list with
/// commas, and throws std::invalid_argument for what cannot be.
void add_text(CLI::App& command, const FieldDescription& field,
              const std::function<void(const std::string&)>& take);
/// Adds every text of `s`, or those with one of `flags` (0: any).
template <typename Struct>
void add_texts(CLI::App& command, Struct& s, unsigned flags = 0) {
  for (const Field<Struct, std::string>& field : fields_of<Struct, std::string>())
    if (flags == 0 || field.has(flags))
      add_text(command, field, [&s, &field](const std::string& text) { field.set(s, text); });
}
/// Makes a check that refuses a text that is not a whole number within these bounds.
CLI::Validator whole_number(std::uint64_t min, std::uint64_t max);
/// Returns whether an option is a switch: it takes no value, or true or false.
bool is_switch(const CLI::Option& option);
/// Adds checks to the options of this command: numbers must be finite, and a switch takes only true or false.
/// Call it when all options are there.
void check_values(CLI::App& command);
/// Makes a check that refuses an empty text.
CLI::Validator not_empty();

/// Adds an option that holds a positive number in this unit, showing its default.
template <typename T>
void add_positive(CLI::App& command, const std::string& name, T& value, const std::string& unit,
                  const std::string& what) {
  command.add_option(name, value, what)->check(positive_number())->type_name(unit)->capture_default_str();
}

/// Adds an option that holds a whole number from 1 to `max`, showing its default.
template <typename T>
void add_count(CLI::App& command, const std::string& name, T& value, std::uint64_t max,
               const std::string& what) {
  command.add_option(name, value, what)
      ->check(whole_number(1, max))
      ->type_name("COUNT")
      ->capture_default_str();
}
inline constexpr std::uint64_t kMaxThreads = 256;

}  // namespace osteomill::app
