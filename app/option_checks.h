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

/// Returns the end of a message about an unknown word: "; did you mean point-shell?" if a known word is
/// similar, otherwise "; there are milling and wall" if the known words are few, otherwise empty.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& known);

/// Throws std::invalid_argument, "there is no algorithm x; did you mean ...", if `word` is not one of
/// `names`.
void require_word(const std::string& kind, const std::string& word, const std::vector<std::string>& names);
/// Makes a check that accepts only `names`; `kind` is used in its message ("algorithm").
CLI::Validator one_of(const std::string& kind, const std::vector<std::string>& names);
/// Stores the accepted names in a check, for choices_of.
CLI::Validator with_choices(CLI::Validator check, const std::vector<std::string>& names);
/// Returns the names that an option accepts, if its first check stores them as that of one_of does.
std::vector<std::string> choices_of(CLI::Option& option);

/// Formats a default value for help: "0.3".
std::string number_text(double value);

/// Returns the names of a command's options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command);

/// Throws CLI::ParseError, naming the most similar known word, if the command or one of its options is
/// unknown. Call it before parsing, which would report a missing option first.
void require_known_words(const CLI::App& program, int argc, const char* const* argv);

/// Parses a number of this range into `value`. Returns an error message, "-1 is not a positive number", or an
/// empty text.
std::string number_fault(const std::string& text, const NumberRange& range, double& value);
/// Parses a number or the name of a choice. Throws std::invalid_argument, one line, if the text is neither.
double value_of(const FieldDescription& field, const std::string& text);
/// Formats a value for help; a choice by its name.
std::string value_text(const FieldDescription& field, double value);
/// Makes a check that accepts only numbers of this range.
CLI::Validator number_of(const NumberRange& range);
inline CLI::Validator positive_number() {
  return number_of(NumberRange::positive());
}

/// Adds an option for a number or a choice, or a switch that --no-NAME turns off.
void add_number(CLI::App& command, const FieldDescription& field, const std::string& shown_default,
                const std::function<void(double)>& take);
/// Adds every field of `s` that has an option and one of `flags` (0: any). Help shows the current value as
/// the default, except for fields with the flag `without_default`.
template <typename Struct>
void add_fields(CLI::App& command, Struct& s, unsigned flags = 0, unsigned without_default = 0) {
  for (const Field<Struct>& field : fields_of<Struct>()) {
    if (field.option.empty() || (flags != 0 && !field.has(flags))) continue;
    add_number(command, field, field.has(without_default) ? "" : value_text(field, field.get(s)),
               [&s, &field](double value) { field.set(s, value); });
  }
}
/// Adds an option for a non-empty text or a list of such texts, which may repeat. `take` receives a list
/// joined with commas, and throws std::invalid_argument if the text is invalid.
void add_text(CLI::App& command, const FieldDescription& field,
              const std::function<void(const std::string&)>& take);
/// Adds every text field of `s` that has one of `flags` (0: any).
template <typename Struct>
void add_texts(CLI::App& command, Struct& s, unsigned flags = 0) {
  for (const Field<Struct, std::string>& field : fields_of<Struct, std::string>())
    if (flags == 0 || field.has(flags))
      add_text(command, field, [&s, &field](const std::string& text) { field.set(s, text); });
}
/// Makes a check that accepts only whole numbers from `min` to `max`.
CLI::Validator whole_number(std::uint64_t min, std::uint64_t max);
/// Returns whether an option is a switch, which needs no value but accepts true or false.
bool is_switch(const CLI::Option& option);
/// Adds checks to all options of the command: numbers must be finite, switches must be true or false. Call it
/// after all options have been added.
void check_values(CLI::App& command);
/// Makes a check that refuses an empty text.
CLI::Validator not_empty();

/// Adds an option for a positive number in this unit; help shows its default.
template <typename T>
void add_positive(CLI::App& command, const std::string& name, T& value, const std::string& unit,
                  const std::string& what) {
  command.add_option(name, value, what)->check(positive_number())->type_name(unit)->capture_default_str();
}

/// Adds an option for a whole number from 1 to `max`; help shows its default.
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
