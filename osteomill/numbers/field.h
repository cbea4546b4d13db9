#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace osteomill {

/// The numbers that are allowed; both ends belong to them. An infinite end allows an infinite value; not a
/// number is allowed by no range.
struct NumberRange {
  double min = std::numeric_limits<double>::lowest();
  double max = std::numeric_limits<double>::max();
  /// A switch (0 or 1), a count or a choice.
  bool whole = false;

  friend bool operator==(const NumberRange&, const NumberRange&) = default;

  /// Returns whether the value is allowed.
  bool contains(double value) const {
    return value >= min && value <= max && (!whole || value == std::floor(value));
  }

  static constexpr NumberRange finite() { return {}; }
  static constexpr NumberRange positive() { return {.min = std::numeric_limits<double>::min()}; }
  static constexpr NumberRange not_negative() { return {.min = 0}; }
  static constexpr NumberRange on_or_off() { return {.min = 0, .max = 1, .whole = true}; }
  static constexpr NumberRange count(int min, int max = std::numeric_limits<int>::max()) {
    return {.min = static_cast<double>(min), .max = static_cast<double>(max), .whole = true};
  }
};

/// Describes one number of a struct once, for everything that names, reads, checks, sets or shows it: the
/// command line, files, tables. Switches are 0 or 1.
template <typename Struct>
struct Field {
  std::string name;
  /// Of ASCII ("mm^3"); empty for a pure number.
  std::string unit;
  NumberRange range;
  /// One line.
  std::string doc;
  std::function<double(const Struct&)> get;
  std::function<void(Struct&, double)> set;
  /// What else holds of it, as the struct's header defines.
  unsigned flags = 0;

  bool has(unsigned flag) const { return (flags & flag) != 0; }
};

/// Returns every field of a struct, in the order in which people should read them; specialised beside each
/// struct that has any. The list is made at the first call and stays.
template <typename Struct>
const std::vector<Field<Struct>>& fields_of();

/// Makes the field of a number, a switch or an enumeration. `place` gives a reference to it: a pointer to the
/// member, or a function that takes the struct, constant or not.
template <typename Struct, typename Place>
Field<Struct> field(std::string name, std::string unit, Place place, NumberRange range, std::string doc,
                    unsigned flags = 0) {
  using Value = std::remove_cvref_t<std::invoke_result_t<Place, Struct&>>;
  return {std::move(name),
          std::move(unit),
          range,
          std::move(doc),
          [place](const Struct& s) { return static_cast<double>(std::invoke(place, s)); },
          [place](Struct& s, double value) {
            if constexpr (std::is_same_v<Value, bool>) {
              std::invoke(place, s) = value != 0;
            } else {
              std::invoke(place, s) = static_cast<Value>(value);
            }
          },
          flags};
}

/// Returns the fields of a part of `Outer` as fields of the whole. `place` gives a reference to the part.
template <typename Outer, typename Place,
          typename Inner = std::remove_cvref_t<std::invoke_result_t<Place, Outer&>>>
std::vector<Field<Outer>> fields_within(Place place, const std::vector<Field<Inner>>& inner) {
  std::vector<Field<Outer>> fields;
  for (const Field<Inner>& one : inner) {
    fields.push_back(
        {one.name, one.unit, one.range, one.doc,
         [place, get = one.get](const Outer& outer) { return get(std::invoke(place, outer)); },
         [place, set = one.set](Outer& outer, double value) { set(std::invoke(place, outer), value); },
         one.flags});
  }
  return fields;
}

/// Returns the field of this name; null where there is none.
template <typename Struct>
const Field<Struct>* find_field(const std::vector<Field<Struct>>& fields, std::string_view name) {
  const auto found = std::ranges::find(fields, name, &Field<Struct>::name);
  return found == fields.end() ? nullptr : &*found;
}

}  // namespace osteomill
