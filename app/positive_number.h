#pragma once

#include <string>

#include <CLI/App.hpp>
#include <CLI/Option.hpp>
#include <CLI/Validators.hpp>

namespace osteomill::app {

/// Refuses what is not a finite number above zero.
CLI::Validator positive_number();

/// Adds an option that holds one, showing its default.
template <typename T>
void add_positive(CLI::App& command, const std::string& name, T& value, const std::string& what) {
  command.add_option(name, value, what)->check(positive_number())->capture_default_str();
}

}  // namespace osteomill::app
