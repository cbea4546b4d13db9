#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace osteomill {

/// How a label is called and shown, as far as a file says so.
struct LabelStyle {
  std::string name;
  std::optional<std::array<std::uint8_t, 3>> colour;
};
/// By the label's value.
using LabelTable = std::map<int, LabelStyle>;

/// A colour table of 3D Slicer's (.ctbl or .txt): a line a label, "value name red green blue alpha", colours
/// from 0 to 255; lines that begin with # and empty ones say nothing. Throws InputError, naming the file and
/// the line.
LabelTable read_label_table(const std::filesystem::path& path);

/// What the key/value pairs of a segmentation of 3D Slicer's (.seg.nrrd) say: Segment0_Name, _Color (three
/// numbers from 0 to 1) and _LabelValue, and so on from 0. Throws InputError naming `subject`.
LabelTable label_table_of(const std::string& subject, const std::map<std::string, std::string>& key_values);

}  // namespace osteomill
