#include "app/option_checks.h"

#include <algorithm>
#include <cctype>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <utility>

#include <CLI/Error.hpp>
#include <CLI/StringTools.hpp>
#include <fmt/format.h>

#include "osteomill/base/parse_number.h"

namespace osteomill::app {

namespace {

// Levenshtein 1966: number of letters to insert, delete or replace to turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, diagonal + 1, changed});
    }
  }
  return row.back();
}

std::string without_leading_dashes(std::string_view word) {
  const std::size_t first = word.find_first_not_of('-');
  std::string bare(first == std::string_view::npos ? "" : word.substr(first));
  std::transform(bare.begin(), bare.end(), bare.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return bare;
}

// Returns the edit distance of two words; 1 if one is a prefix of the other and has at
// least three letters.
std::size_t distance(const std::string& word, const std::string& known) {
  constexpr std::size_t kMaxDistance = 3;
  const std::size_t common = std::min(word.size(), known.size());
  if (common >= kMaxDistance && word.compare(0, common, known, 0, common) == 0) return 1;
  return edit_distance(word, known);
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& known) {
  const std::string bare = without_leading_dashes(word);
  std::size_t least = std::max<std::size_t>(1, bare.size() / 3) + 1;
  std::optional<std::string> best;
  for (const std::string& one : known) {
    const std::size_t far = distance(bare, without_leading_dashes(one));
    if (far < least) {
      least = far;
      best = one;
    }
  }
  return best;
}

std::string joined_with_and(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t n = 0; n < words.size(); ++n) {
    text += (n == 0 ? "" : n + 1 == words.size() ? " and " : ", ") + words[n];
  }
  return text;
}

class UnknownWord : public CLI::ParseError {
 public:
  explicit UnknownWord(const std::string& what)
      : CLI::ParseError("UnknownWord", what, CLI::ExitCodes::ExtrasError) {}
};

std::string see_help(const std::string& hint, const std::string& of) {
  return hint.empty() ? fmt::format("; {} --help lists them", of) : hint;
}

// Excludes "-0.5", a number, and "--", which ends the options.
bool is_option(std::string_view word) {
  if (word.size() < 2 || word[0] != '-') return false;
  return word[1] == '-' ? word.size() > 2 : std::isalpha(static_cast<unsigned char>(word[1])) != 0;
}

}  // namespace

std::string did_you_mean(std::string_view word, const std::vector<std::string>& known) {
  constexpr std::size_t kMaxListed = 5;
  if (const auto near = nearest(word, known)) return fmt::format("; did you mean {}?", *near);
  if (known.size() > kMaxListed || known.empty()) return "";
  return fmt::format("; there {} {}", known.size() == 1 ? "is" : "are", joined_with_and(known));
}

void require_word(const std::string& kind, const std::string& word, const std::vector<std::string>& names) {
  if (std::ranges::find(names, word) == names.end())
    throw std::invalid_argument(fmt::format("there is no {} {}{}", kind, word, did_you_mean(word, names)));
}

CLI::Validator one_of(const std::string& kind, const std::vector<std::string>& names) {
  CLI::Validator check(
      [=](std::string& word) {
        try {
          require_word(kind, word, names);
          return std::string();
        } catch (const std::invalid_argument& fault) {
          return std::string(fault.what());
        }
      },
      "");
  return with_choices(std::move(check), names);
}

// Stored in the check's name, which is not displayed.
CLI::Validator with_choices(CLI::Validator check, const std::vector<std::string>& names) {
  check.name(fmt::format("{}", fmt::join(names, "|")));
  return check;
}

std::vector<std::string> choices_of(CLI::Option& option) {
  try {
    const std::string names = option.get_validator(0)->get_name();
    return names.empty() ? std::vector<std::string>() : CLI::detail::split(names, '|');
  } catch (const CLI::OptionNotFound&) {
    return {};
  }
}

std::vector<std::string> option_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

void require_known_words(const CLI::App& program, int argc, const char* const* argv) {
  const CLI::App* command = nullptr;
  for (int n = 1; n < argc; ++n) {
    const std::string word = argv[n];
    if (word == "--") return;
    const CLI::App& where = command != nullptr ? *command : program;
    if (is_option(word)) {
      const std::string name = word[1] == '-' ? word.substr(0, word.find('=')) : word.substr(0, 2);
      if (where.get_option_no_throw(name) == nullptr) {
        throw UnknownWord(fmt::format("{} has no option {}{}", where.get_name(), name,
                                      see_help(did_you_mean(name, option_names(where)), where.get_name())));
      }
    } else if (command == nullptr) {
      std::vector<std::string> names;
      for (const CLI::App* one : program.get_subcommands({})) {
        names.push_back(one->get_name());
        if (one->get_name() == word) command = one;
      }
      if (command == nullptr) {
        throw UnknownWord(fmt::format("there is no command {}{}", word,
                                      see_help(did_you_mean(word, names), program.get_name())));
      }
    }
  }
}

std::string number_text(double value) {
  return fmt::format("{:g}", value);
}

std::string number_fault(const std::string& text, const NumberRange& range, double& value) {
  if (range == NumberRange::on_or_off() && (text == "true" || text == "false")) {
    value = text == "true" ? 1 : 0;
    return "";
  }
  value = parse_number<double>(text).value_or(std::numeric_limits<double>::quiet_NaN());
  if (range.contains(value)) return "";
  const bool is_positive = range == NumberRange::positive();
  return fmt::format("{} is not {}", text, is_positive ? "a positive number" : range_text(range));
}

double value_of(const FieldDescription& field, const std::string& text) {
  if (!field.choices.empty()) {
    require_word(field.option, text, field.choices);
    return static_cast<double>(std::ranges::find(field.choices, text) - field.choices.begin());
  }
  double value = 0;
  if (const std::string fault = number_fault(text, field.range, value); !fault.empty())
    throw std::invalid_argument(field.option + ": " + fault);
  return value;
}

std::string value_text(const FieldDescription& field, double value) {
  return field.choices.empty() ? number_text(value) : field.choices.at(static_cast<std::size_t>(value));
}

CLI::Validator number_of(const NumberRange& range) {
  return CLI::Validator(
      [range](std::string& text) {
        double value = 0;
        return text.empty() ? "is empty" : number_fault(text, range, value);
      },
      "");
}

namespace {

// Returns the unit as one word for help: "mm³/(N.s)".
std::string help_unit(std::string unit) {
  if (unit.empty()) return "NUMBER";
  std::replace(unit.begin(), unit.end(), ' ', '.');
  for (const auto& [power, digit] : {std::pair("^2", "²"), std::pair("^3", "³")}) {
    for (auto at = unit.find(power); at != std::string::npos; at = unit.find(power))
      unit.replace(at, 2, digit);
  }
  return unit;
}

}  // namespace

void add_number(CLI::App& command, const FieldDescription& field, const std::string& shown_default,
                const std::function<void(double)>& take) {
  // A longer list would push the description out of its column.
  constexpr std::size_t kListed = 8;
  const std::string name = "--" + field.option;
  if (!field.choices.empty()) {
    command
        .add_option_function<std::string>(
            name, [field, take](const std::string& text) { take(value_of(field, text)); }, field.doc)
        ->check(one_of(field.option, field.choices))
        ->type_name(field.choices.size() > kListed ? "NAME"
                                                   : fmt::format("{}", fmt::join(field.choices, "|")))
        ->default_str(shown_default);
    return;
  }
  if (field.range == NumberRange::on_or_off()) {
    command.add_flag_function(
        name + ",!--no-" + field.option, [take](std::int64_t times) { take(times > 0 ? 1 : 0); }, field.doc);
    return;
  }
  CLI::Option* option = command.add_option_function<double>(name, take, field.doc)
                            ->check(number_of(field.range))
                            ->type_name(field.range.whole ? "COUNT" : help_unit(field.unit));
  if (!shown_default.empty()) option->default_str(shown_default);
}

void add_text(CLI::App& command, const FieldDescription& field,
              const std::function<void(const std::string&)>& take) {
  const std::string name = "--" + field.option;
  const auto take_checked = [take, name](const std::string& text) {
    try {
      take(text);
    } catch (const std::invalid_argument& error) {
      throw CLI::ValidationError(name, error.what());
    }
  };
  CLI::Option* option = nullptr;
  if (field.range.whole) {
    const auto take_all = [take_checked](const std::vector<std::string>& texts) {
      take_checked(fmt::format("{}", fmt::join(texts, ",")));
    };
    option = command.add_option_function<std::vector<std::string>>(name, take_all, field.doc)->delimiter(',');
    if (field.range.max == field.range.min) option->expected(static_cast<int>(field.range.max));
  } else {
    option = command.add_option_function<std::string>(name, take_checked, field.doc);
  }
  option->check(not_empty())->type_name(field.unit);
}

CLI::Validator whole_number(std::uint64_t min, std::uint64_t max) {
  return CLI::Validator(
      [=](std::string& text) {
        const auto value = parse_number<std::uint64_t>(text);
        const bool good = value && *value >= min && *value <= max;
        return good ? std::string() : fmt::format("{} is not a whole number from {} to {}", text, min, max);
      },
      "");
}

namespace {

// Decides by the option's type name, to which CLI11 appends its check after a colon.
bool takes_words(const CLI::Option& option) {
  constexpr std::string_view kWords[] = {
      "TEXT",   "FILE",      "FOLDER", "FILE|FOLDER", "TRAJECTORY|RECORDING",
      "SERIES", "LABEL,...", "DEVICE", "HOST",        "SETTING"};
  const std::string type = option.get_type_name();
  return std::ranges::find(kWords, type.substr(0, type.find(':'))) != std::end(kWords);
}

}  // namespace

bool is_switch(const CLI::Option& option) {
  return option.get_expected_max() == 0;
}

void check_values(CLI::App& command) {
  const CLI::Validator finite(
      [](std::string& text) {
        const bool good = !parse_number<double>(text) || parse_finite(text);
        return good ? std::string() : text + " is not a finite number";
      },
      "");
  const CLI::Validator on_or_off(
      [](std::string& text) {
        return text == "true" || text == "false" ? std::string() : text + " is neither true nor false";
      },
      "");
  for (CLI::Option* option : command.get_options()) {
    if (is_switch(*option)) {
      option->check(on_or_off);
    } else if (!takes_words(*option)) {
      option->check(finite);
    }
  }
}

CLI::Validator not_empty() {
  return CLI::Validator([](std::string& text) { return text.empty() ? "is empty" : std::string(); }, "");
}

}  // namespace osteomill::app
