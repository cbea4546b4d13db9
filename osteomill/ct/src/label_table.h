#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "osteomill/ct/read_scan.h"

#include "volume_file.h"

namespace osteomill {

using Colour = std::array<std::uint8_t, 3>;

/// Name and colour of a label, as far as a file contains them.
struct LabelStyle {
  std::string name;
  std::optional<Colour> colour;
};
/// Styles by label value.
using LabelTable = std::map<int, LabelStyle>;

/// Parses a whole number; returns nullopt if the text is anything else.
std::optional<int> whole_number(const std::string& text);

/// Reads a colour table of 3D Slicer or a label description file of ITK-SNAP. Throws InputError, naming the
/// file and the line.
LabelTable read_label_table(const std::filesystem::path& path);

/// Returns the label names and colours in a volume file: from the key/value pairs of a 3D Slicer segmentation
/// (Segment0_Name, _Color with three numbers from 0 to 1, _LabelValue, and so on), or from a NIfTI extension
/// in XML (Caret's LabelTable, which TotalSegmentator writes) or JSON. Throws InputError, naming `subject`.
LabelTable label_table_of(const std::string& subject, const VolumeHeader& header);

/// Returns the names and colours of `Scan::labels` as a table.
LabelTable table_of(const std::vector<LabelName>& names);

/// Parses label names from XML or JSON; returns an empty table for any other text. For file extensions
/// without a documented meaning.
LabelTable labels_in_text(const std::string& text);

}  // namespace osteomill
