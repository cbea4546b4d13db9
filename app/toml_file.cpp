#include "app/toml_file.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

#include <fmt/core.h>

#include "osteomill/base/input_files.h"
#include "osteomill/haptics/algorithms.h"

namespace osteomill::app {

namespace {

// The library recurses over the parts of a dotted name, so too many would overflow the stack; and it uses
// many times the file's size in memory.
void require_readable(const std::string& file) {
  constexpr std::ptrdiff_t kMaxDots = 1000;
  constexpr std::uintmax_t kMaxBytes = 16'000'000;
  std::error_code error;
  if (std::filesystem::file_size(file, error) > kMaxBytes)
    throw InputError(file, fmt::format("is longer than {} MB", kMaxBytes / 1'000'000));
  std::ifstream in(file);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (std::count(line.begin(), line.end(), '.') > kMaxDots)
      throw InputError(file, fmt::format("line {}: has a name with over {} parts", number, kMaxDots));
  }
}

}  // namespace

toml::table parse_toml(const std::string& file) {
  const std::filesystem::file_status status = std::filesystem::status(file);
  if (!std::filesystem::exists(status)) throw InputError(file, "no such file");
  if (!std::filesystem::is_regular_file(status)) throw InputError(file, "is not a regular file");
  require_readable(file);
  try {
    return toml::parse_file(file);
  } catch (const toml::parse_error& error) {
    throw InputError(file, fmt::format("line {}: {}", error.source().begin.line, error.description()));
  }
}

toml::table read_toml(const std::string& file) {
  toml::table table = parse_toml(file);
  register_input(file);
  return table;
}

std::vector<TomlEntry> entries_of(const toml::table& table) {
  std::vector<TomlEntry> entries;
  for (auto&& [key, value] : table) entries.push_back({std::string(key.str()), &value});
  std::ranges::sort(entries, {}, [](const TomlEntry& entry) {
    const toml::source_position at = entry.value->source().begin;
    return std::pair(at.line, at.column);
  });
  return entries;
}

std::vector<TomlEntry> options_of(const toml::table& table) {
  std::vector<TomlEntry> options;
  for (const TomlEntry& entry : entries_of(table)) {
    const toml::table* own = entry.value->as_table();
    if (own == nullptr || find_algorithm(entry.key) == nullptr) {
      options.push_back(entry);
      continue;
    }
    for (const TomlEntry& setting : entries_of(*own))
      options.push_back({entry.key + "." + setting.key, setting.value});
  }
  return options;
}

bool is_algorithm_setting(const std::string& key) {
  return key.find('.') != std::string::npos;
}

InputError error_at(const toml::node& place, const std::string& file, const std::string& reason) {
  return {file, fmt::format("line {}: {}", place.source().begin.line, reason)};
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
      throw error_at(node, file, key + " takes a text, a number, true or false, or a list of them");
    }
  };
  if (const toml::array* list = value.as_array()) {
    if (list->empty()) throw error_at(value, file, key + " is an empty list");
    for (const toml::node& node : *list) take(node);
  } else {
    take(value);
  }
  return values;
}

}  // namespace osteomill::app
