// Nearly Raw Raster Data, http://teem.sourceforge.net/nrrd/format.html
#include <array>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "header_text.h"
#include "volume_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

struct Header {
  HeaderFields fields;
  std::map<std::string, std::string> key_values{};
  // An empty line parts the header from what follows it.
  bool has_end = false;
};

// Longer headers than this are no headers.
constexpr std::size_t kMaxHeader = 1 << 22;

// "data file" and "datafile" are the same field.
std::string field_name(std::string_view text) {
  std::string name = lower(std::string(text));
  std::erase(name, ' ');
  return name;
}

// A field with a slip of the pen in its name would be missed in silence.
void check_name(const std::string& subject, const std::string& name) {
  constexpr std::string_view kNames =
      "|axismaxs|axismins|blocksize|byteskip|centerings|centers|content|data|datafile|dimension|"
      "encoding|endian|kinds|labels|lineskip|max|measurementframe|min|number|oldmax|oldmin|"
      "sampleunits|sizes|space|spacedimension|spacedirections|spaceorigin|spaceunits|spacings|"
      "thicknesses|type|units|";
  if (kNames.find("|" + name + "|") == std::string_view::npos) {
    throw InputError(subject, fmt::format("has a field \"{:.40}\" that is not known", name));
  }
}

Header read_header(const std::string& subject, std::istream& in) {
  Header header{{subject}};
  std::string line;
  std::size_t length = 0;
  if (!std::getline(in, line) || !line.starts_with("NRRD000") || line.size() < 8 || line[7] < '1' ||
      line[7] > '5') {
    throw InputError(subject, "is not NRRD: it does not begin with NRRD0001 to NRRD0005");
  }
  while (std::getline(in, line)) {
    length += line.size();
    if (length > kMaxHeader) throw InputError(subject, "has a header without an end");
    if (line.ends_with('\r')) line.pop_back();
    if (line.empty()) {
      header.has_end = true;
      break;
    }
    if (line.find('\0') != std::string::npos) throw InputError(subject, "has a zero byte in its header");
    if (line.starts_with('#')) continue;
    if (const std::size_t equals = line.find(":="); equals != std::string::npos) {
      header.key_values[line.substr(0, equals)] = line.substr(equals + 2);
      continue;
    }
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos)
      throw InputError(subject, "has a header line that is not \"field: value\"");
    const std::string name = field_name(std::string_view(line).substr(0, colon));
    check_name(subject, name);
    header.fields.values[name] = trimmed(std::string_view(line).substr(colon + 1));
  }
  return header;
}

VoxelType type_of(const std::string& subject, const std::string& type) {
  using enum VoxelType;
  constexpr std::array<std::pair<VoxelType, std::string_view>, 10> kNames{
      {{int8, "|signed char|int8|int8_t|"},
       {uint8, "|uchar|unsigned char|uint8|uint8_t|"},
       {int16, "|short|short int|signed short|signed short int|int16|int16_t|"},
       {uint16, "|ushort|unsigned short|unsigned short int|uint16|uint16_t|"},
       {int32, "|int|signed int|int32|int32_t|"},
       {uint32, "|uint|unsigned int|uint32|uint32_t|"},
       {int64, "|longlong|long long|long long int|signed long long|signed long long int|int64|int64_t|"},
       {uint64, "|ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t|"},
       {float32, "|float|"},
       {float64, "|double|"}}};
  if (type.empty()) throw InputError(subject, "does not say of what type its voxels are");
  for (const auto& [known, names] : kNames) {
    if (names.find("|" + type + "|") != std::string_view::npos) return known;
  }
  throw InputError(subject, fmt::format("has voxels of type \"{:.40}\", which is not known", type));
}

double unit_of(const HeaderFields& fields, const std::string& name) {
  const std::string text = fields[name];
  const std::size_t open = text.find('"');
  if (open == std::string::npos) return 1;
  return millimetres_in(fields.subject, lower(text.substr(open + 1, text.find('"', open + 1) - open - 1)));
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

// The signs that turn the axes of a space into LPS.
Vec3 lps_from_space(const std::string& subject, const std::string& space,
                    std::vector<std::string>& warnings) {
  if (space.empty() || space == "left-posterior-superior" || space == "lps") return Vec3(1, 1, 1);
  if (space == "right-anterior-superior" || space == "ras") return Vec3(-1, -1, 1);
  if (space == "left-anterior-superior" || space == "las") return Vec3(1, -1, 1);
  if (space != "scanner-xyz" && space != "3d-right-handed" && space != "3d-left-handed") {
    throw InputError(subject, fmt::format("lies in a space that is not known: \"{:.40}\"", space));
  }
  warnings.push_back(fmt::format("lies in the space \"{}\"; its axes were taken for LPS", space));
  return Vec3::Ones();
}

// Along an axis of another kind lie several values of one voxel.
void check_kinds(const std::string& subject, const std::string& kinds) {
  std::istringstream words(lower(kinds));
  for (std::string kind; words >> kind;) {
    if (kind == "list") {
      throw InputError(subject,
                       "has several layers, as a segmentation whose segments overlap; save it with one");
    }
    if (kind != "domain" && kind != "space" && kind != "time" && kind != "???" && kind != "none") {
      throw InputError(subject, fmt::format("is not a grey volume: it has an axis of kind \"{}\"", kind));
    }
  }
}

GridGeometry geometry_of(const HeaderFields& fields, std::vector<std::string>& warnings) {
  const std::string& subject = fields.subject;
  const std::vector<double> dimension = fields.numbers("dimension");
  if (dimension.front() != 3) {
    throw InputError(subject,
                     fmt::format("is not a grey volume: it has {} dimensions, not 3", dimension.front()));
  }
  check_kinds(subject, fields["kinds"]);
  Mat3 axes = Mat3::Identity();
  std::vector<double> spacing{1, 1, 1};
  double unit_mm = 1;
  if (fields.has("spacedirections")) {
    axes = space_directions(subject, fields["spacedirections"]);
    for (int axis = 0; axis < 3; ++axis) spacing[static_cast<std::size_t>(axis)] = axes.col(axis).norm();
    unit_mm = unit_of(fields, "spaceunits");
  } else if (fields.has("spacings")) {
    spacing = fields.numbers("spacings");
    unit_mm = unit_of(fields, "units");
  } else {
    warnings.push_back("does not say how large its voxels are; 1 mm was assumed");
  }
  Vec3 origin = Vec3::Zero();
  if (fields.has("spaceorigin")) {
    const auto values = parse_numbers(fields["spaceorigin"], "(), \t");
    origin = checked_point(subject, "space origin", values.value_or(std::vector<double>{}));
  }
  return checked_geometry(subject, fields.numbers("sizes"), spacing, axes, origin, unit_mm,
                          lps_from_space(subject, lower(fields["space"]), warnings));
}

// The stream in which the voxels begin, behind the lines that are to be skipped.
std::ifstream open_behind_lines(const fs::path& path, const Header& header, std::ifstream attached) {
  const HeaderFields& fields = header.fields;
  const std::string name = fields[fields.has("datafile") ? "datafile" : "data"];
  if (name.empty() && !header.has_end)
    throw InputError(fields.subject, "has a header without an end, and no data");
  std::ifstream in = open_data(fields.subject, path, name, std::move(attached));
  const double lines = fields.count("lineskip", 0);
  for (double n = 0; n < lines && in; ++n) in.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  return in;
}

StoredVoxels voxels_of(const HeaderFields& fields, std::ifstream data, std::uint64_t count) {
  const std::string& subject = fields.subject;
  const VoxelType type = type_of(subject, lower(fields["type"]));
  const std::string encoding = lower(fields["encoding"]);
  const bool is_text = encoding == "ascii" || encoding == "txt" || encoding == "text";
  const bool is_packed = encoding == "gzip" || encoding == "gz";
  if (encoding != "raw" && !is_text && !is_packed) {
    throw InputError(subject, encoding.empty()
                                  ? "does not say how its data are encoded"
                                  : fmt::format("is encoded as \"{}\", which is not supported", encoding));
  }
  StoredVoxels voxels{
      .source = ByteSource(std::move(data), is_packed ? Packing::gzip_or_zlib : Packing::none),
      .type = type,
      .is_text = is_text};
  const std::string endian = lower(fields["endian"]);
  if (!is_text && bytes_of(type) > 1 && endian != "little" && endian != "big") {
    throw InputError(subject, "does not say whether its voxels are little or big endian");
  }
  voxels.big_endian = endian == "big";
  const double byte_skip = fields.count("byteskip", is_text ? 0 : -1);
  if (byte_skip < 0) {
    skip_to_last(voxels, count);
  } else {
    voxels.skip = static_cast<std::uint64_t>(byte_skip);
  }
  return voxels;
}

}  // namespace

VolumeHeader read_nrrd_header(const fs::path& path) {
  std::ifstream in = open_regular_file(path.string(), path);
  const Header header = read_header(path.string(), in);
  std::vector<std::string> warnings;
  const GridGeometry geometry = geometry_of(header.fields, warnings);
  std::ifstream data = open_behind_lines(path, header, std::move(in));
  return {geometry, voxels_of(header.fields, std::move(data), geometry.voxel_count()), std::move(warnings),
          header.key_values, header.key_values.contains("Segment0_ID")};
}

}  // namespace osteomill
