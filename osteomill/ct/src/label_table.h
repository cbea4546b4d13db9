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

/// How a label is called and shown, as far as a file says so.
struct LabelStyle {
  std::string name;
  std::optional<Colour> colour;
};
/// By the label's value.
using LabelTable = std::map<int, LabelStyle>;

/// Returns the number that a text is; nothing if it is none, or not whole.
std::optional<int> whole_number(const std::string& text);

/// Reads a colour table of 3D Slicer's or a label description file of ITK-SNAP's. Throws InputError, naming
/// the file and the line.
LabelTable read_label_table(const std::filesystem::path& path);

/// Returns what a volume file says of its labels: in the key/value pairs of a segmentation of 3D Slicer's
/// (Segment0_Name, _Color, three numbers from 0 to 1, and _LabelValue, and so on), or in an extension
/// of NIfTI, as XML (Caret's LabelTable, which TotalSegmentator writes) or JSON. Throws InputError naming
/// `subject`.
LabelTable label_table_of(const std::string& subject, const VolumeHeader& header);

/// Returns the names and colours that a scan which is a label map gives its labels.
LabelTable table_of(const std::vector<LabelName>& names);

/// Returns the labels that a text names: XML or JSON, anything else names none. For extensions of files whose
/// meaning no document gives.
LabelTable labels_in_text(const std::string& text);

}  // namespace osteomill
