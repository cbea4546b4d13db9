// Nearly Raw Raster Data, http://teem.sourceforge.net/nrrd/format.html
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

struct Fields {
  std::map<std::string, std::string> values;
  /// Just behind the empty line; 0 where there is none.
  std::uint64_t end_of_header = 0;

  std::string operator[](const std::string& name) const {
    const auto found = values.find(name);
    return found == values.end() ? std::string() : found->second;
  }
  bool has(const std::string& name) const { return values.contains(name); }
};

// Longer headers than this are no headers.
constexpr std::size_t kLongestHeader = 1 << 22;

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// "data file" and "datafile" are the same field.
std::string field_name(std::string_view text) {
  std::string name = lower(std::string(text));
  std::erase(name, ' ');
  return name;
}

std::string trimmed(std::string_view text) {
  const std::size_t start = text.find_first_not_of(" \t");
  if (start == std::string_view::npos) return {};
  return std::string(text.substr(start, text.find_last_not_of(" \t") - start + 1));
}

Fields read_fields(const std::string& subject, std::istream& in) {
  Fields fields;
  std::string line;
  std::size_t length = 0;
  if (!std::getline(in, line) || !line.starts_with("NRRD000")) {
    throw InputError(subject, "is not NRRD: it does not begin with NRRD000");
  }
  while (std::getline(in, line)) {
    length += line.size();
    if (length > kLongestHeader) throw InputError(subject, "has a header without an end");
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty()) {
      fields.end_of_header = static_cast<std::uint64_t>(in.tellg());
      break;
    }
    if (line.find('\0') != std::string::npos) throw InputError(subject, "has a zero byte in its header");
    if (line.starts_with('#') || line.find(":=") != std::string::npos) continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos)
      throw InputError(subject, "has a header line that is not \"field: value\"");
    fields.values[field_name(std::string_view(line).substr(0, colon))] =
        trimmed(std::string_view(line).substr(colon + 1));
  }
  return fields;
}

std::uint64_t bytes_of_type(const std::string& subject, const std::string& type) {
  static const std::map<std::string, std::uint64_t> kBytes{{"signed char", 1},
                                                           {"int8", 1},
                                                           {"int8_t", 1},
                                                           {"uchar", 1},
                                                           {"unsigned char", 1},
                                                           {"uint8", 1},
                                                           {"uint8_t", 1},
                                                           {"short", 2},
                                                           {"short int", 2},
                                                           {"signed short", 2},
                                                           {"signed short int", 2},
                                                           {"int16", 2},
                                                           {"int16_t", 2},
                                                           {"ushort", 2},
                                                           {"unsigned short", 2},
                                                           {"unsigned short int", 2},
                                                           {"uint16", 2},
                                                           {"uint16_t", 2},
                                                           {"int", 4},
                                                           {"signed int", 4},
                                                           {"int32", 4},
                                                           {"int32_t", 4},
                                                           {"uint", 4},
                                                           {"unsigned int", 4},
                                                           {"uint32", 4},
                                                           {"uint32_t", 4},
                                                           {"longlong", 8},
                                                           {"long long", 8},
                                                           {"long long int", 8},
                                                           {"signed long long", 8},
                                                           {"signed long long int", 8},
                                                           {"int64", 8},
                                                           {"int64_t", 8},
                                                           {"ulonglong", 8},
                                                           {"unsigned long long", 8},
                                                           {"unsigned long long int", 8},
                                                           {"uint64", 8},
                                                           {"uint64_t", 8},
                                                           {"float", 4},
                                                           {"double", 8}};
  const auto found = kBytes.find(type);
  if (found == kBytes.end()) {
    throw InputError(subject, type.empty()
                                  ? "does not say of what type its voxels are"
                                  : fmt::format("has voxels of type \"{}\", which is not known", type));
  }
  return found->second;
}

std::vector<double> numbers(const std::string& subject, const Fields& fields, const std::string& name) {
  const auto values = parse_numbers(fields[name]);
  if (!values || values->empty())
    throw InputError(subject, fmt::format("has a field \"{}\" without numbers", name));
  return *values;
}

double unit_of(const std::string& subject, const Fields& fields, const std::string& name) {
  const std::string text = fields[name];
  const std::size_t open = text.find('"');
  if (open == std::string::npos) return 1;
  return millimetres_in(subject, lower(text.substr(open + 1, text.find('"', open + 1) - open - 1)));
}

Mat3 space_directions(const std::string& subject, const std::string& text) {
  std::vector<double> values;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t open = rest.find('(');
    if (open == std::string_view::npos) break;
    if (rest.substr(0, open).find_first_not_of(" \t") != std::string_view::npos) break;
    const std::size_t close = rest.find(')');
    if (close == std::string_view::npos || close < open) break;
    const auto vector = parse_numbers(rest.substr(open + 1, close - open - 1), " ,\t");
    if (!vector || vector->size() != 3) break;
    values.insert(values.end(), vector->begin(), vector->end());
    rest.remove_prefix(close + 1);
  }
  if (values.size() != 9 || rest.find_first_not_of(" \t") != std::string_view::npos) {
    throw InputError(subject, "has space directions that are not three vectors of three numbers");
  }
  Mat3 axes;
  for (int axis = 0; axis < 3; ++axis) {
    for (int row = 0; row < 3; ++row) axes(row, axis) = values[static_cast<std::size_t>(3 * axis + row)];
  }
  return axes;
}

void check_placement(const std::string& subject, const Fields& fields, VolumeHeader& header) {
  if (fields.has("spacedirections")) {
    check_axes(subject, space_directions(subject, fields["spacedirections"]));
    header.unit_mm = unit_of(subject, fields, "spaceunits");
  } else if (fields.has("spacings")) {
    check_spacing(subject, numbers(subject, fields, "spacings"));
    header.unit_mm = unit_of(subject, fields, "units");
  } else {
    header.warnings.push_back("does not say how large its voxels are; 1 mm was assumed");
  }
  if (fields.has("spaceorigin")) {
    const auto origin = parse_numbers(fields["spaceorigin"], "(), \t");
    if (!origin || origin->size() != 3 || !Vec3((*origin)[0], (*origin)[1], (*origin)[2]).allFinite()) {
      throw InputError(subject, "has a space origin that is not three numbers");
    }
  }
  static const std::vector<std::string> kPatient{
      "",    "left-posterior-superior", "lps", "right-anterior-superior",
      "ras", "left-anterior-superior",  "las"};
  const std::string space = lower(fields["space"]);
  if (std::find(kPatient.begin(), kPatient.end(), space) == kPatient.end()) {
    header.warnings.push_back(fmt::format("lies in the space \"{}\"; its axes were taken for LPS", space));
  }
}

std::uint64_t after_lines(const fs::path& file, std::uint64_t offset, double lines) {
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(offset));
  std::string line;
  for (double n = 0; n < lines && std::getline(in, line); ++n) offset += line.size() + 1;
  return offset;
}

double skip_of(const std::string& subject, const Fields& fields, const std::string& name, double least) {
  if (!fields.has(name)) return 0;
  const std::vector<double> values = numbers(subject, fields, name);
  if (values.size() != 1 || !(values[0] >= least && values[0] < 1e12)) {
    throw InputError(subject, fmt::format("has a {} that is not supported: {}", name, fields[name]));
  }
  return values[0];
}

StoredVoxels where_stored(const std::string& subject, const fs::path& path, const Fields& fields) {
  StoredVoxels stored;
  const std::string name = fields[fields.has("datafile") ? "datafile" : "data"];
  if (name.empty()) {
    if (fields.end_of_header == 0) throw InputError(subject, "has a header without an end, and no data");
    stored.file = path;
    stored.offset = fields.end_of_header;
  } else if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    throw InputError(subject, "keeps its data in several files, which is not supported");
  } else {
    stored.file = path.parent_path() / name;
  }
  stored.offset = after_lines(stored.file, stored.offset, skip_of(subject, fields, "lineskip", 0));
  return stored;
}

void check_data(const std::string& subject, StoredVoxels stored, const Fields& fields, VolumeHeader& header) {
  const std::uint64_t value_bytes = bytes_of_type(subject, lower(fields["type"]));
  GridGeometry grid;
  grid.dims = header.dims;
  stored.bytes = grid.voxel_count() * value_bytes;
  const std::string encoding = lower(fields["encoding"]);
  if (encoding == "ascii" || encoding == "txt" || encoding == "text") {
    // One digit and one space each, at the least.
    stored.bytes = 2 * grid.voxel_count() - 1;
    check_stored(subject, stored);
    return;
  }
  stored.compressed = encoding == "gzip" || encoding == "gz";
  if (encoding != "raw" && !stored.compressed) {
    throw InputError(subject, encoding.empty()
                                  ? "does not say how its data are encoded"
                                  : fmt::format("is encoded as \"{}\", which is not supported", encoding));
  }
  const std::string endian = lower(fields["endian"]);
  if (value_bytes > 1 && endian != "little" && endian != "big") {
    throw InputError(subject, "does not say whether its voxels are little or big endian");
  }
  const double byte_skip = skip_of(subject, fields, "byteskip", -1);
  if (byte_skip < 0) {
    // The voxels are what the data end with.
    std::error_code error;
    const std::uint64_t size = fs::file_size(stored.file, error);
    if (!stored.compressed && !error && size >= stored.offset + stored.bytes)
      stored.offset = size - stored.bytes;
    check_stored(subject, stored);
    return;
  }
  (stored.compressed ? stored.compressed_skip : stored.offset) += static_cast<std::uint64_t>(byte_skip);
  const std::vector<std::string> more = check_stored(subject, stored);
  header.warnings.insert(header.warnings.end(), more.begin(), more.end());
}

}  // namespace

VolumeHeader check_nrrd(const fs::path& path) {
  const std::string subject = path.string();
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(subject, "cannot be read");
  const Fields fields = read_fields(subject, in);

  VolumeHeader header;
  const std::vector<double> dimension = numbers(subject, fields, "dimension");
  if (dimension.front() != 3) {
    throw InputError(subject,
                     fmt::format("is not a grey volume: it has {} dimensions, not 3", dimension.front()));
  }
  header.dims = checked_dims(subject, numbers(subject, fields, "sizes"));
  check_placement(subject, fields, header);
  check_data(subject, where_stored(subject, path, fields), fields, header);
  return header;
}

}  // namespace osteomill
