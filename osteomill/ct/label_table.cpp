#include "osteomill/ct/label_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <vector>

#include <fmt/format.h>

#include "osteomill/ct/byte_source.h"
#include "osteomill/ct/header_text.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace {

using Colour = std::array<std::uint8_t, 3>;

// Longer names than this are no names; and control characters are none.
constexpr std::size_t kMaxName = 100;
std::string usable_name(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c < ' ' || c == 127; }, ' ');
  return trimmed(name.substr(0, kMaxName));
}

std::optional<Colour> colour_of(const std::vector<double>& channels, double white) {
  Colour colour{};
  if (channels.size() < colour.size()) return std::nullopt;
  for (std::size_t n = 0; n < colour.size(); ++n) {
    const double level = std::round(255 * channels[n] / white);
    if (!(level >= 0 && level <= 255)) return std::nullopt;
    colour[n] = static_cast<std::uint8_t>(level);
  }
  return colour;
}

std::optional<int> whole_number(const std::string& text) {
  constexpr double kMax = 1e9;
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 1 || !(std::abs(numbers->front()) <= kMax) ||
      numbers->front() != std::floor(numbers->front())) {
    return std::nullopt;
  }
  return static_cast<int>(numbers->front());
}

// "value name red green blue alpha", of which the name may be several words.
bool add_line(const std::string& line, LabelTable& table) {
  constexpr std::size_t kChannels = 4;
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  if (words.size() < kChannels + 2) return false;
  std::string name, channels;
  for (std::size_t n = 1; n < words.size(); ++n) {
    std::string& text = n + kChannels < words.size() ? name : channels;
    text += (text.empty() ? "" : " ") + words[n];
  }
  const auto value = whole_number(words.front());
  const auto numbers = parse_numbers(channels);
  const auto colour = numbers ? colour_of(*numbers, 255) : std::nullopt;
  if (!value || !colour) return false;
  // Slicer writes names as one word.
  std::replace(name.begin(), name.end(), '_', ' ');
  table[*value] = {usable_name(name), colour};
  return true;
}

}  // namespace

LabelTable read_label_table(const std::filesystem::path& path) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;
  const std::string subject = path.string();
  std::ifstream in = open_regular_file(subject, path);
  LabelTable table;
  if (std::filesystem::file_size(path) > kMaxBytes)
    throw InputError(subject, "is too long for a table of labels");
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = trimmed(line);
    if (line.empty() || line.starts_with('#')) continue;
    if (!add_line(line, table)) {
      throw InputError(
          subject,
          fmt::format("line {} is not \"value name red green blue alpha\", colours from 0 to 255", number));
    }
  }
  if (table.empty()) throw InputError(subject, "has no labels");
  return table;
}

LabelTable label_table_of(const std::string& subject, const std::map<std::string, std::string>& key_values) {
  LabelTable table;
  for (int n = 0;; ++n) {
    const auto find = [&](const char* what) { return key_values.find(fmt::format("Segment{}_{}", n, what)); };
    const auto name = find("Name"), value = find("LabelValue"), colour = find("Color");
    const auto end = key_values.end();
    if (name == end && value == end) return table;
    // Segmentations from before there were label values have them in order, from 1.
    const auto label = value == end ? n + 1 : whole_number(value->second);
    if (!label) {
      throw InputError(subject, fmt::format("has a Segment{}_LabelValue that is not a whole number", n));
    }
    LabelStyle style;
    if (name != end) style.name = usable_name(name->second);
    if (colour != end) {
      if (const auto channels = parse_numbers(colour->second)) style.colour = colour_of(*channels, 1);
    }
    table[*label] = style;
  }
}

}  // namespace osteomill
