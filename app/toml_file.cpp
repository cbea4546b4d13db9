#include "app/toml_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include <fmt/core.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/input_files.h"

namespace osteomill::app {

namespace {

// The library reads the parts of a dotted name by recursion: too many of them would overflow the stack.
void require_short_names(const std::string& file) {
  constexpr std::ptrdiff_t kMaxDots = 1000;
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (std::count(line.begin(), line.end(), '.') > kMaxDots)
      throw InputError(file, fmt::format("line {}: has a name of over {} parts", number, kMaxDots));
  }
}

}  // namespace

toml::table read_toml(const std::string& file) {
  if (!std::filesystem::is_regular_file(file)) throw InputError(file, "no such file");
  note_input(file);
  require_short_names(file);
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    throw InputError(file, fmt::format("line {}: {}", error.source().begin.line, error.description()));
  }
}

std::vector<std::string> option_values(const toml::node& value, const std::string& file,
                                       const std::string& key) {
  std::vector<std::string> values;
  const auto take = [&](const toml::node& node) {
    if (const auto text = node.value_exact<std::string>()) {
      values.push_back(*text);
    } else if (const auto whole = node.value_exact<int64_t>()) {
      values.push_back(fmt::format("{}", *whole));
    } else if (const auto number = node.value_exact<double>()) {
      values.push_back(fmt::format("{}", *number));
    } else if (const auto flag = node.value_exact<bool>()) {
      values.push_back(*flag ? "true" : "false");
    } else {
      throw InputError(file,
                       fmt::format("line {}: {} takes a text, a number, true or false, or a list of them",
                                   node.source().begin.line, key));
    }
  };
  if (const toml::array* list = value.as_array()) {
    for (const toml::node& node : *list) take(node);
  } else {
    take(value);
  }
  return values;
}

}  // namespace osteomill::app
