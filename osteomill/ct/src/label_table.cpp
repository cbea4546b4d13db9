#include "label_table.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "osteomill/base/input_error.h"

#include "byte_source.h"
#include "header_text.h"
#include "utf8_text.h"

namespace osteomill {

namespace fs = std::filesystem;

std::optional<int> whole_number(const std::string& text) {
  constexpr double kMax = 1e9;
  const auto numbers = parse_numbers(text);
  if (!numbers || numbers->size() != 1 || !(std::abs(numbers->front()) <= kMax) ||
      numbers->front() != std::floor(numbers->front())) {
    return std::nullopt;
  }
  return static_cast<int>(numbers->front());
}

namespace {

// Maximum length of a name, bytes; longer ones are cut. Control characters are replaced. Older programs write
// Latin 1.
constexpr std::size_t kMaxName = 100;
std::string usable_name(const std::string& name) {
  std::string shown = without_controls(is_utf8(name) ? name : utf8_of_latin1(name), ' ');
  if (shown.size() > kMaxName) shown.resize(kMaxName);
  // Do not end inside a multi-byte character.
  while (!is_utf8(shown)) shown.pop_back();
  return trimmed(shown);
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

// Parses a line "value red green blue opacity shown meshed "name"" of ITK-SNAP.
bool add_snap_line(const std::string& line, LabelTable& table) {
  const std::size_t open = line.find('"');
  const auto numbers = parse_numbers(line.substr(0, open));
  if (!numbers || numbers->size() != 7 || line.size() < open + 2) return false;
  const auto value = whole_number(line.substr(0, line.find_first_of(" \t")));
  const auto colour = colour_of({numbers->begin() + 1, numbers->end()}, 255);
  if (!value || !colour) return false;
  table[*value] = {usable_name(line.substr(open + 1, line.size() - open - 2)), colour};
  return true;
}

// Parses a line "value name red green blue alpha", whose name may have several words.
bool add_line(const std::string& line, LabelTable& table) {
  if (line.ends_with('"')) return add_snap_line(line, table);
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
  // Slicer writes names as one word, with underscores.
  std::replace(name.begin(), name.end(), '_', ' ');
  table[*value] = {usable_name(name), colour};
  return true;
}

// Reads the key/value pairs of a 3D Slicer segmentation (.seg.nrrd): Segment0_Name, _Color (three numbers
// from 0 to 1), _LabelValue, and so on. Throws InputError, naming `subject`.
LabelTable segments_in(const std::string& subject, const std::map<std::string, std::string>& key_values) {
  LabelTable table;
  for (const int n : segment_numbers(key_values)) {
    const auto find = [&](const char* what) { return key_values.find(fmt::format("Segment{}_{}", n, what)); };
    const auto name = find("Name"), value = find("LabelValue"), colour = find("Color");
    const auto end = key_values.end();
    if (name == end && value == end) continue;
    // Older segmentations have no label values; they are numbered from 1.
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
  return table;
}

using Json = nlohmann::json;

std::optional<int> value_in(const Json& json) {
  if (json.is_number_integer() && std::abs(json.get<double>()) <= 1e9) return json.get<int>();
  return json.is_string() ? whole_number(json.get<std::string>()) : std::nullopt;
}

// Returns the first of these members that exists.
const Json* member(const Json& object, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (object.contains(name)) return &object[name];
  return nullptr;
}

std::optional<Colour> colour_in(const Json* json) {
  if (json == nullptr || !json->is_array()) return std::nullopt;
  std::vector<double> channels;
  for (const Json& channel : *json)
    if (channel.is_number()) channels.push_back(channel.get<double>());
  const bool are_shares =
      std::all_of(channels.begin(), channels.end(), [](double channel) { return channel <= 1; });
  return colour_of(channels, are_shares ? 1 : 255);
}

// Adds labels from JSON such as {"26": "mandible"}, {"labels": {"mandible": 26}} and [{"value": 26, "name":
// "mandible"}], up to kDeepest levels deep.
void add_labels(const Json& json, bool of_labels, int depth, LabelTable& table) {
  constexpr int kDeepest = 8;
  if (depth > kDeepest || !json.is_structured()) return;
  if (json.is_object()) {
    const Json* const value = member(json, {"value", "label", "labelValue", "index", "id", "key"});
    const Json* const name = member(json, {"name", "labelName", "text"});
    if (value != nullptr && name != nullptr && name->is_string()) {
      if (const auto label = value_in(*value)) {
        table[*label] = {usable_name(name->get<std::string>()),
                         colour_in(member(json, {"color", "colour", "rgb", "rgba"}))};
        return;
      }
    }
  }
  for (const auto& [key, inside] : json.items()) {
    const auto number = json.is_object() ? whole_number(key) : std::nullopt;
    if (number && inside.is_string()) {
      table[*number] = {usable_name(inside.get<std::string>()), std::nullopt};
    } else if (of_labels && inside.is_number_integer()) {
      if (const auto label = value_in(inside)) table[*label] = {usable_name(key), std::nullopt};
    } else {
      add_labels(inside, lower(key).find("label") != std::string::npos, depth + 1, table);
    }
  }
}

// Returns the value of an attribute of an XML element, given the text between its angle brackets.
std::string attribute(std::string_view tag, std::string_view name) {
  for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
    const std::size_t open = tag.find_first_not_of(" \t\r\n=", at + name.size());
    const bool is_whole = at > 0 && std::isspace(static_cast<unsigned char>(tag[at - 1])) != 0;
    if (!is_whole || open == std::string_view::npos || (tag[open] != '"' && tag[open] != '\'')) continue;
    const std::size_t close = tag.find(tag[open], open + 1);
    return std::string(tag.substr(open + 1, close == std::string_view::npos ? close : close - open - 1));
  }
  return {};
}

std::string plain_text(std::string text) {
  constexpr std::string_view kOpen = "<![CDATA[", kClose = "]]>";
  if (const std::size_t at = text.find(kOpen); at != std::string::npos) {
    const std::size_t from = at + kOpen.size();
    return text.substr(from, text.find(kClose, from) - from);
  }
  constexpr std::array<std::pair<std::string_view, char>, 5> kEntities{
      {{"&lt;", '<'}, {"&gt;", '>'}, {"&quot;", '"'}, {"&apos;", '\''}, {"&amp;", '&'}}};
  for (const auto& [entity, letter] : kEntities)
    for (std::size_t at = 0; (at = text.find(entity, at)) != std::string::npos; ++at)
      text.replace(at, entity.size(), 1, letter);
  return text;
}

// <Label Key="26" Red="0.9" Green="0.9" Blue="0.6" Alpha="1">mandible</Label>.
void add_labels_of_xml(std::string_view xml, LabelTable& table) {
  constexpr std::string_view kOpen = "<Label", kClose = "</Label>";
  for (std::size_t at = xml.find(kOpen); at != std::string_view::npos; at = xml.find(kOpen, at + 1)) {
    // <LabelTable> is another element.
    if (xml.substr(at + kOpen.size()).find_first_of(" \t\r\n") != 0) continue;
    const std::size_t end = xml.find('>', at), close = xml.find(kClose, at);
    if (end == std::string_view::npos || close == std::string_view::npos || close < end) return;
    const std::string_view tag = xml.substr(at, end - at);
    const auto value = whole_number(attribute(tag, "Key"));
    if (!value) continue;
    const auto channels =
        parse_numbers(attribute(tag, "Red") + " " + attribute(tag, "Green") + " " + attribute(tag, "Blue"));
    table[*value] = {usable_name(plain_text(std::string(xml.substr(end + 1, close - end - 1)))),
                     channels ? colour_of(*channels, 1) : std::nullopt};
  }
}

}  // namespace

LabelTable labels_in_text(const std::string& text) {
  LabelTable table;
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  if (start == std::string::npos) return table;
  if (text[start] == '<') add_labels_of_xml(text, table);
  if (text[start] == '{' || text[start] == '[') {
    // Extensions are zero-padded.
    const std::string json = text.substr(start, std::min(text.find('\0'), text.size()) - start);
    add_labels(Json::parse(json, nullptr, false), false, 0, table);
  }
  return table;
}

LabelTable table_of(const std::vector<LabelName>& names) {
  LabelTable table;
  for (const LabelName& label : names) table[label.value] = {usable_name(label.name), label.colour};
  return table;
}

LabelTable read_label_table(const fs::path& path) {
  constexpr std::uintmax_t kMaxBytes = 1 << 20;
  const std::string subject = path.string();
  std::ifstream in = open_regular_file(subject, path);
  LabelTable table;
  if (fs::file_size(path) > kMaxBytes)
    throw InputError(subject, "is longer than 1 MB, too long for a table of labels");
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    // Some editors start a text with a byte order mark.
    constexpr std::string_view kMark = "\xEF\xBB\xBF";
    if (number == 1 && line.starts_with(kMark)) line.erase(0, kMark.size());
    line = trimmed(line);
    if (line.empty() || line.starts_with('#')) continue;
    if (!add_line(line, table)) {
      throw InputError(
          subject,
          fmt::format(
              "line {} is neither \"value name red green blue alpha\" nor ITK-SNAP's \"value red green "
              "blue opacity shown meshed \"name\"\", colours from 0 to 255",
              number));
    }
  }
  if (table.empty()) throw InputError(subject, "holds no labels");
  return table;
}

LabelTable label_table_of(const std::string& subject, const VolumeHeader& header) {
  LabelTable table = segments_in(subject, header.key_values);
  for (const std::string& text : header.texts) table.merge(labels_in_text(text));
  return table;
}

}  // namespace osteomill
