#pragma once

#include <cstdint>
#include <string>

#include <CLI/App.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

namespace osteomill::app {

/// Refuses what is not a finite number above zero.
CLI::Validator positive_number();
/// Refuses what is not a whole number within these bounds.
CLI::Validator whole_number(std::uint64_t min, std::uint64_t max);
/// Refuses an empty text.
CLI::Validator not_empty();

/// Adds an option that holds a positive number in this unit, showing its default.
template <typename T>
void add_positive(CLI::App& command, const std::string& name, T& value, const std::string& unit,
                  const std::string& what) {
  command.add_option(name, value, what)->check(positive_number())->type_name(unit)->capture_default_str();
}

}  // namespace osteomill::app
