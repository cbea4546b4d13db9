// MetaImage, https://itk.org/Wiki/ITK/MetaIO/Documentation
#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "osteomill/ct/parse_numbers.h"
#include "osteomill/ct/volume_header.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestHeader = 1 << 20;

struct Fields {
  std::map<std::string, std::string> values;
  std::uint64_t end_of_header = 0;

  bool has(const std::string& name) const { return values.contains(name); }
  std::string operator[](const std::string& name) const {
    return has(name) ? values.at(name) : std::string();
  }
  bool is_true(const std::string& name) const {
    const std::string value = (*this)[name];
    return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
  }
  // The first of several names for the same thing.
  std::string first_of(std::initializer_list<const char*> names) const {
    for (const char* name : names) {
      if (has(name)) return name;
    }
    return {};
  }
};

std::string trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t\r");
  if (start == std::string_view::npos) return {};
  return std::string(text.substr(start, text.find_last_not_of(" \t\r") - start + 1));
}

// The header ends with the line that names the data.
Fields read_fields(const std::string& subject, std::istream& in) {
  Fields fields;
  std::string line;
  std::size_t length = 0;
  while (!fields.has("ElementDataFile") && std::getline(in, line)) {
    length += line.size();
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos || length > kLongestHeader || line.find('\0') != std::string::npos) {
      throw InputError(subject, "is not MetaImage: its header is not made of \"name = value\"");
    }
    fields.values[trimmed(std::string_view(line).substr(0, equals))] =
        trimmed(std::string_view(line).substr(equals + 1));
  }
  if (!fields.has("ElementDataFile"))
    throw InputError(subject, "does not say where its data are (ElementDataFile)");
  fields.end_of_header = in.eof() ? length : static_cast<std::uint64_t>(in.tellg());
  return fields;
}

std::vector<double> numbers(const std::string& subject, const Fields& fields, const std::string& name) {
  const auto values = parse_numbers(fields[name]);
  if (!values || values->empty()) throw InputError(subject, fmt::format("has no {} made of numbers", name));
  return *values;
}

std::uint64_t bytes_of_type(const std::string& subject, const std::string& type) {
  // MET_LONG is 4 bytes in a file, whatever it is on the machine.
  static const std::map<std::string, std::uint64_t> kBytes{
      {"MET_CHAR", 1},      {"MET_UCHAR", 1},      {"MET_SHORT", 2}, {"MET_USHORT", 2},
      {"MET_INT", 4},       {"MET_UINT", 4},       {"MET_LONG", 4},  {"MET_ULONG", 4},
      {"MET_LONG_LONG", 8}, {"MET_ULONG_LONG", 8}, {"MET_FLOAT", 4}, {"MET_DOUBLE", 8}};
  const auto found = kBytes.find(type);
  if (found == kBytes.end()) {
    throw InputError(subject, fmt::format("has voxels of type \"{}\", which is not supported", type));
  }
  return found->second;
}

void check_placement(const std::string& subject, const Fields& fields, VolumeHeader& header) {
  const std::string spacing = fields.first_of({"ElementSpacing", "ElementSize"});
  if (spacing.empty()) {
    header.warnings.push_back("does not say how large its voxels are; 1 mm was assumed");
  } else {
    check_spacing(subject, numbers(subject, fields, spacing));
  }
  const std::string matrix = fields.first_of({"TransformMatrix", "Rotation", "Orientation"});
  if (!matrix.empty()) {
    const std::vector<double> values = numbers(subject, fields, matrix);
    if (values.size() != 9)
      throw InputError(subject, fmt::format("has a {} that is not nine numbers", matrix));
    check_axes(subject, Eigen::Map<const Mat3>(values.data()));
  }
  const std::string origin = fields.first_of({"Offset", "Position", "Origin"});
  if (!origin.empty()) {
    const std::vector<double> values = numbers(subject, fields, origin);
    if (values.size() != 3 || !Vec3(values[0], values[1], values[2]).allFinite()) {
      throw InputError(subject, fmt::format("has a {} that is not three numbers", origin));
    }
  }
  std::string unit = fields["DistanceUnits"];
  std::transform(unit.begin(), unit.end(), unit.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  header.unit_mm = millimetres_in(subject, unit);
}

StoredVoxels where_stored(const std::string& subject, const fs::path& path, const Fields& fields,
                          std::uint64_t bytes) {
  const std::string name = fields["ElementDataFile"];
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    throw InputError(subject, "keeps its data in several files, which is not supported");
  }
  StoredVoxels stored;
  const bool local = name == "LOCAL" || name == "Local" || name == "local";
  stored.file = local ? path : path.parent_path() / name;
  stored.offset = local ? fields.end_of_header : 0;
  stored.bytes = bytes;
  stored.compressed = fields.is_true("CompressedData");
  if (stored.compressed && fields.has("CompressedDataSize")) {
    // MetaIO decompresses that much and no more, and leaves the other voxels zero.
    const double size = numbers(subject, fields, "CompressedDataSize").front();
    if (!(size >= 1 && size < 1e12)) throw InputError(subject, "has no sensible CompressedDataSize");
    stored.compressed_bytes = static_cast<std::uint64_t>(size);
  }
  if (fields.has("HeaderSize")) {
    const std::vector<double> skip = numbers(subject, fields, "HeaderSize");
    if (skip.size() != 1 || !(skip[0] >= -1 && skip[0] < 1e12))
      throw InputError(subject, "has no sensible HeaderSize");
    std::error_code error;
    const std::uint64_t size = fs::file_size(stored.file, error);
    if (skip[0] < 0) {
      stored.offset = !error && size >= bytes ? size - bytes : 0;
    } else if (skip[0] > 0) {
      stored.offset = static_cast<std::uint64_t>(skip[0]);
    }
  }
  return stored;
}

}  // namespace

VolumeHeader check_metaimage(const fs::path& path) {
  const std::string subject = path.string();
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(subject, "cannot be read");
  const Fields fields = read_fields(subject, in);

  VolumeHeader header;
  if (numbers(subject, fields, "NDims").front() != 3)
    throw InputError(subject, "is not a volume: NDims is not 3");
  header.dims = checked_dims(subject, numbers(subject, fields, "DimSize"));
  const std::uint64_t value_bytes = bytes_of_type(subject, fields["ElementType"]);
  if (fields.has("ElementNumberOfChannels") &&
      numbers(subject, fields, "ElementNumberOfChannels").front() != 1) {
    throw InputError(subject, "is not a grey volume: it holds several values a voxel");
  }
  if (fields.has("BinaryData") && !fields.is_true("BinaryData")) {
    throw InputError(subject, "holds its voxels as text, which is not supported");
  }
  check_placement(subject, fields, header);
  GridGeometry grid;
  grid.dims = header.dims;
  const std::vector<std::string> more =
      check_stored(subject, where_stored(subject, path, fields, grid.voxel_count() * value_bytes));
  header.warnings.insert(header.warnings.end(), more.begin(), more.end());
  return header;
}

}  // namespace osteomill
