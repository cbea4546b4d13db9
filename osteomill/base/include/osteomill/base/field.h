#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace osteomill {

/// A range of allowed numbers, ends included. An infinite end allows an infinite value; no range allows NaN.
struct NumberRange {
  double min = std::numeric_limits<double>::lowest();
  double max = std::numeric_limits<double>::max();
  /// True if only whole numbers are allowed: a switch (0 or 1), a count or a choice.
  bool whole = false;

  friend bool operator==(const NumberRange&, const NumberRange&) = default;

  /// Returns whether the value is allowed.
  bool contains(double value) const {
    return value >= min && value <= max && (!whole || value == std::floor(value));
  }

  static constexpr NumberRange finite() { return {}; }
  static constexpr NumberRange positive() { return {.min = std::numeric_limits<double>::min()}; }
  static constexpr NumberRange not_negative() { return {.min = 0}; }
  /// Returns the range of a limit: not negative; infinity means no limit.
  static constexpr NumberRange limit() { return {.min = 0, .max = std::numeric_limits<double>::infinity()}; }
  static constexpr NumberRange on_or_off() { return {.min = 0, .max = 1, .whole = true}; }
  static constexpr NumberRange count(int min, int max = std::numeric_limits<int>::max()) {
    return {.min = static_cast<double>(min), .max = static_cast<double>(max), .whole = true};
  }
};

/// Returns a description of the range: "a number above 0", "a whole number from 1 to 32", "on or off".
std::string range_text(const NumberRange& range);

/// Describes one value for all code that checks, shows, reads or writes it: the command line, files, tables.
/// Use designated initialisers, because most fields omit some members:
/// `{.name = "push", .unit = "N", .range = NumberRange::positive(), .doc = "Push", .option = "push"}`.
struct FieldDescription {
  /// The name in files; empty if files do not store the value.
  std::string name = {};
  /// The unit, in ASCII as in settings files ("mm^3"); empty for a dimensionless number. For a text, a
  /// placeholder word ("FILE").
  std::string unit = {};
  /// The allowed values of a number; a switch is 0 or 1. For a text that is a list, the allowed number of
  /// entries.
  NumberRange range = {};
  /// A one-line description.
  std::string doc = {};
  /// Bits for further properties, defined in the struct's header.
  unsigned flags = 0;
  /// The name of the command-line option, which is also its key in --config files and studies; empty if there
  /// is none.
  std::string option = {};
  /// The names of the values 0, 1, ... of a choice, as used by options and studies.
  std::vector<std::string> choices = {};

  bool has(unsigned flag) const { return (flags & flag) != 0; }
  /// Returns the name of a choice's value, or "on" or "off" for a switch; nothing for any other number.
  std::optional<std::string> name_of_value(double value) const {
    if (choices.empty() && range == NumberRange::on_or_off()) return value == 0 ? "off" : "on";
    if (!(value >= 0 && value < static_cast<double>(choices.size()))) return std::nullopt;
    return choices[static_cast<std::size_t>(value)];
  }
};

/// Flag for the fields of any struct: files may omit it; it then keeps its default.
inline constexpr unsigned kMayBeAbsent = 1u << 31;

/// One value of a struct: a number, or a text.
template <typename Struct, typename Value = double>
struct Field : FieldDescription {
  std::function<Value(const Struct&)> get;
  std::function<void(Struct&, const Value&)> set;
};

/// Returns all fields of a struct that are numbers, or texts, in reading order; specialised beside each
/// struct that has any. The list is created by the first call and stays valid.
template <typename Struct, typename Value = double>
const std::vector<Field<Struct, Value>>& fields_of();

/// Creates the field of a number, a switch, an enumeration, a text or a path. `access` gives a reference to
/// it: a member pointer, or a function that takes the struct, const or not.
template <typename Struct, typename Access>
auto field(FieldDescription description, Access access) {
  using Value = std::remove_cvref_t<std::invoke_result_t<Access, Struct&>>;
  using Stored =
      std::conditional_t<std::is_arithmetic_v<Value> || std::is_enum_v<Value>, double, std::string>;
  return Field<Struct, Stored>{
      std::move(description),
      [access](const Struct& s) { return static_cast<Stored>(std::invoke(access, s)); },
      [access](Struct& s, const Stored& value) {
        if constexpr (std::is_same_v<Value, bool>) {
          std::invoke(access, s) = value != 0;
        } else {
          std::invoke(access, s) = static_cast<Value>(value);
        }
      }};
}

/// Returns the fields of a member of `Outer` as fields of `Outer`. `access` gives a reference to the member.
template <typename Outer, typename Access, typename Value,
          typename Inner = std::remove_cvref_t<std::invoke_result_t<Access, Outer&>>>
std::vector<Field<Outer, Value>> fields_within(Access access, const std::vector<Field<Inner, Value>>& inner) {
  std::vector<Field<Outer, Value>> fields;
  for (const Field<Inner, Value>& one : inner) {
    fields.push_back({one,
                      [access, get = one.get](const Outer& outer) { return get(std::invoke(access, outer)); },
                      [access, set = one.set](Outer& outer, const Value& value) {
                        set(std::invoke(access, outer), value);
                      }});
  }
  return fields;
}

/// Concatenates lists of fields.
template <typename Struct, typename Value = double>
std::vector<Field<Struct, Value>> joined(std::vector<std::vector<Field<Struct, Value>>> lists) {
  std::vector<Field<Struct, Value>> all;
  for (std::vector<Field<Struct, Value>>& list : lists) std::ranges::move(list, std::back_inserter(all));
  return all;
}

/// Returns the field of this name; null if there is none.
template <typename Struct, typename Value>
const Field<Struct, Value>* find_field(const std::vector<Field<Struct, Value>>& fields,
                                       std::string_view name) {
  const auto found = std::ranges::find(fields, name, &FieldDescription::name);
  return found == fields.end() ? nullptr : &*found;
}
/// Returns the field of this option; null if there is none, or `option` is empty.
template <typename Struct, typename Value>
const Field<Struct, Value>* field_of_option(const std::vector<Field<Struct, Value>>& fields,
                                            std::string_view option) {
  const auto found = std::ranges::find(fields, option, &FieldDescription::option);
  return found == fields.end() || option.empty() ? nullptr : &*found;
}

}  // namespace osteomill
