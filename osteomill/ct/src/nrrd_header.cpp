// Nearly Raw Raster Data, http://teem.sourceforge.net/nrrd/format.html
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <optional>
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
  // True if an empty line ends the header, after which data may follow.
  bool has_end = false;
};

// Maximum length of a header, bytes.
constexpr std::size_t kMaxHeader = 1 << 22;

// Normalises a field name: "data file" and "datafile" are the same.
std::string field_name(std::string_view text) {
  std::string name = lower(std::string(text));
  std::erase(name, ' ');
  return name;
}

// Rejects unknown names, because a misspelt field would be ignored silently.
void check_name(const std::string& subject, const std::string& name) {
  constexpr std::string_view kNames =
      "|axismaxs|axismins|blocksize|byteskip|centerings|centers|content|data|datafile|dimension|"
      "encoding|endian|kinds|labels|lineskip|max|measurementframe|min|number|oldmax|oldmin|"
      "sampleunits|sizes|space|spacedimension|spacedirections|spaceorigin|spaceunits|spacings|"
      "thicknesses|type|units|";
  if (kNames.find("|" + name + "|") == std::string_view::npos) {
    throw InputError(subject, fmt::format("has an unknown field \"{:.40}\"", name));
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
    const std::string value = header.fields.values[name] = trimmed(std::string_view(line).substr(colon + 1));
    // The rest of the file lists the data files.
    if (name.starts_with("data") && (value == "LIST" || value.starts_with("LIST "))) break;
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
  if (type.empty()) throw InputError(subject, "does not state the type of its voxels");
  for (const auto& [known, names] : kNames) {
    if (names.find("|" + type + "|") != std::string_view::npos) return known;
  }
  throw InputError(subject, fmt::format("has voxels of the unknown type \"{:.40}\"", type));
}

// Returns the quoted texts of a field, or its words if it has no quotes.
std::vector<std::string> texts_of(const std::string& field) {
  std::vector<std::string> texts;
  if (field.find('"') == std::string::npos) {
    std::istringstream words(field);
    for (std::string word; words >> word;) texts.push_back(word);
    return texts;
  }
  for (std::size_t open = field.find('"'); open != std::string::npos;) {
    const std::size_t close = field.find('"', open + 1);
    texts.push_back(field.substr(open + 1, close - open - 1));
    open = close == std::string::npos ? close : field.find('"', close + 1);
  }
  return texts;
}

// Returns the unit of each axis; a single unit applies to all.
std::vector<std::string> units_of(const HeaderFields& fields, const std::string& name, std::size_t axes) {
  std::vector<std::string> units = texts_of(fields[name]);
  if (units.empty()) units.emplace_back();
  if (units.size() == 1) units.resize(axes, units.front());
  if (units.size() != axes)
    throw InputError(fields.subject, fmt::format("has {} units for its {} axes", units.size(), axes));
  return units;
}

double millimetres(const HeaderFields& fields, const std::string& unit) {
  return millimetres_in(fields.subject, lower(unit));
}

// Returns the step along each axis in the coordinates of the space; nullopt for an axis without a direction
// ("none").
std::vector<std::optional<std::vector<double>>> space_directions(const std::string& subject,
                                                                 std::string_view rest) {
  constexpr std::size_t kMostAxes = 16;
  std::vector<std::optional<std::vector<double>>> directions;
  const auto refused = [&] {
    return InputError(subject, "has space directions that are not a vector of three numbers for each axis");
  };
  while (directions.size() <= kMostAxes) {
    const std::size_t start = rest.find_first_not_of(" \t");
    if (start == std::string_view::npos) return directions;
    rest.remove_prefix(start);
    if (rest.starts_with("none")) {
      directions.emplace_back();
      rest.remove_prefix(4);
      continue;
    }
    const std::size_t close = rest.find(')');
    if (rest.front() != '(' || close == std::string_view::npos) throw refused();
    auto vector = parse_numbers(rest.substr(1, close - 1), " ,\t");
    if (!vector || vector->size() < 3 || vector->size() > 4) throw refused();
    directions.emplace_back(*std::move(vector));
    rest.remove_prefix(close + 1);
  }
  throw refused();
}

// Returns the signs that convert the axes of a space to LPS.
Vec3 lps_from_space(const std::string& subject, std::string space, std::vector<std::string>& warnings) {
  // Ignores time, a fourth axis of the space.
  if (space.ends_with("-time")) space.resize(space.size() - 5);
  if (space == "lpst" || space == "rast" || space == "last") space.pop_back();
  if (space.empty() || space == "left-posterior-superior" || space == "lps") return Vec3(1, 1, 1);
  if (space == "right-anterior-superior" || space == "ras") return Vec3(-1, -1, 1);
  if (space == "left-anterior-superior" || space == "las") return Vec3(1, -1, 1);
  if (space != "scanner-xyz" && space != "3d-right-handed" && space != "3d-left-handed") {
    throw InputError(subject, fmt::format("is in an unknown space: \"{:.40}\"", space));
  }
  warnings.push_back(fmt::format("is in the space \"{}\"; its axes were assumed to be LPS", space));
  return Vec3::Ones();
}

bool is_spatial(const std::string& kind) {
  return kind == "domain" || kind == "space" || kind == "???" || kind == "none";
}

// Rejects axes of other kinds, along which a voxel has several values.
void check_kind(const std::string& subject, const std::string& kind) {
  if (kind == "list") {
    throw InputError(
        subject, "has several layers, as a segmentation with overlapping segments; save it with one layer");
  }
  if (!is_spatial(kind) && kind != "time")
    throw InputError(subject, fmt::format("is not a grey volume: it has an axis of kind \"{:.40}\"", kind));
}

// Axes of the file's array, fastest first.
struct Axes {
  std::vector<double> sizes;
  std::vector<std::string> kinds;
  std::vector<std::optional<std::vector<double>>> directions;
  // Indices of the grid's three axes.
  std::vector<std::size_t> of_grid;
};

// Returns the axes with a direction, or of a spatial kind; if they are more than three, drops those of size
// 1.
std::vector<std::size_t> axes_of_grid(const Axes& axes) {
  std::vector<std::size_t> found;
  for (std::size_t axis = 0; axis < axes.sizes.size(); ++axis) {
    const bool in_space = axes.directions.empty() ? is_spatial(axes.kinds[axis]) || axes.sizes.size() == 3
                                                  : axes.directions[axis].has_value();
    if (in_space) found.push_back(axis);
  }
  // Last axes first, because axes of size 1 usually follow the others.
  for (std::size_t n = found.size(); n-- > 0 && found.size() > 3;)
    if (axes.sizes[found[n]] == 1) found.erase(found.begin() + static_cast<std::ptrdiff_t>(n));
  return found;
}

Axes axes_of(const HeaderFields& fields) {
  const std::string& subject = fields.subject;
  const double dimension = fields.numbers("dimension").front();
  Axes axes{fields.numbers("sizes"), texts_of(lower(fields["kinds"])), {}, {}};
  if (!(dimension >= 3 && dimension <= 16)) {
    throw InputError(subject, fmt::format("is not a grey volume: it has {} dimensions, not 3", dimension));
  }
  if (static_cast<double>(axes.sizes.size()) != dimension)
    throw InputError(subject, fmt::format("has {} sizes and {} dimensions", axes.sizes.size(), dimension));
  axes.kinds.resize(axes.sizes.size(), "???");
  if (fields.has("spacedirections")) {
    axes.directions = space_directions(subject, fields["spacedirections"]);
    if (axes.directions.size() != axes.sizes.size()) {
      throw InputError(subject, fmt::format("has {} space directions and {} dimensions",
                                            axes.directions.size(), dimension));
    }
  }
  axes.of_grid = axes_of_grid(axes);
  if (axes.of_grid.size() != 3) {
    throw InputError(subject, fmt::format("is not a grey volume: {} of its {} axes are spatial, not 3",
                                          axes.of_grid.size(), dimension));
  }
  return axes;
}

// Returns the layers along the axes outside the grid, usually one. Overlapping segments lie along one axis,
// the first or the last.
VoxelLayers layers_of(const Header& header, const Axes& axes) {
  VoxelLayers layers;
  for (std::size_t axis = 0; axis < axes.sizes.size(); ++axis) {
    const bool of_grid = std::find(axes.of_grid.begin(), axes.of_grid.end(), axis) != axes.of_grid.end();
    if (of_grid || axes.sizes[axis] == 1) continue;
    const bool run_fastest = axis < axes.of_grid.front();
    const bool are_segments = !segment_numbers(header.key_values).empty() ||
                              header.fields.subject.find(".seg.") != std::string::npos;
    const double count = axes.sizes[axis];
    if (!are_segments || layers.count > 1 || !(count >= 1 && count <= 1e6) || count != std::floor(count) ||
        !(run_fastest || axis > axes.of_grid.back())) {
      throw InputError(header.fields.subject,
                       fmt::format("holds {} volumes or values per voxel, not one", count));
    }
    layers = {static_cast<std::uint64_t>(count), run_fastest};
  }
  return layers;
}

GridGeometry geometry_of(const HeaderFields& fields, const Axes& axes, std::vector<std::string>& warnings) {
  const std::string& subject = fields.subject;
  std::vector<double> sizes, spacing{1, 1, 1};
  for (const std::size_t axis : axes.of_grid) {
    sizes.push_back(axes.sizes[axis]);
    if (axes.sizes.size() == 3) check_kind(subject, axes.kinds[axis]);
  }
  const bool has_time = lower(fields["space"]).ends_with("time") || fields["space"].size() == 4;
  const std::vector<std::string> space_units = units_of(fields, "spaceunits", has_time ? 4 : 3);
  const Vec3 space_unit_mm(millimetres(fields, space_units[0]), millimetres(fields, space_units[1]),
                           millimetres(fields, space_units[2]));
  Mat3 steps = Mat3::Identity();
  if (!axes.directions.empty()) {
    for (std::size_t n = 0; n < 3; ++n) {
      const auto column = static_cast<Eigen::Index>(n);
      steps.col(column) = space_unit_mm.cwiseProduct(Vec3(axes.directions[axes.of_grid[n]]->data()));
      spacing[n] = steps.col(column).norm();
    }
  } else if (fields.has("spacings")) {
    const std::vector<double> all = fields.numbers("spacings");
    if (all.size() != axes.sizes.size())
      throw InputError(subject, fmt::format("has {} spacings for {} axes", all.size(), axes.sizes.size()));
    const std::vector<std::string> units = units_of(fields, "units", axes.sizes.size());
    for (std::size_t n = 0; n < 3; ++n)
      spacing[n] = all[axes.of_grid[n]] * millimetres(fields, units[axes.of_grid[n]]);
  } else {
    warnings.push_back("has no voxel size; 1 mm was assumed");
  }
  Vec3 origin = Vec3::Zero();
  if (fields.has("spaceorigin")) {
    auto values = parse_numbers(fields["spaceorigin"], "(), \t").value_or(std::vector<double>{});
    if (has_time && values.size() == 4) values.pop_back();
    origin = space_unit_mm.cwiseProduct(checked_point(subject, "space origin", values));
  }
  const Vec3 lps_from_axes = lps_from_space(subject, lower(fields["space"]), warnings);
  return checked_geometry(subject, sizes, spacing, steps, origin, 1, warnings, lps_from_axes);
}

StoredVoxels voxels_of(const fs::path& path, const Header& header, std::ifstream in, std::uint64_t count) {
  const HeaderFields& fields = header.fields;
  const std::string& subject = fields.subject;
  const VoxelType type = type_of(subject, lower(fields["type"]));
  const std::string encoding = lower(fields["encoding"]);
  const bool is_text = encoding == "ascii" || encoding == "txt" || encoding == "text";
  const bool is_packed = encoding == "gzip" || encoding == "gz";
  if (encoding != "raw" && !is_text && !is_packed) {
    throw InputError(subject, encoding.empty()
                                  ? "does not state its encoding"
                                  : fmt::format("is encoded as \"{}\", which is not supported", encoding));
  }
  const std::string name = fields[fields.has("datafile") ? "datafile" : "data"];
  if (name.empty() && !header.has_end) throw InputError(subject, "has a header without an end and no data");
  std::vector<fs::path> files;
  if (!name.empty()) {
    files = data_files(subject, path, name, in);
    in = open_regular_file(subject, files.front());
    files.erase(files.begin());
  }
  const double byte_skip = fields.count("byteskip", is_text ? 0 : -1);
  const BeforeVoxels before{.lines = fields.count("lineskip", 0),
                            .bytes = static_cast<std::uint64_t>(std::max(0.0, byte_skip)),
                            .are_last = byte_skip < 0};
  StoredVoxels voxels{
      .source = source_behind(std::move(in), before, is_packed ? Packing::gzip_or_zlib : Packing::none),
      .type = type,
      .is_text = is_text,
      .more = std::move(files),
      .before = before};
  const std::string endian = lower(fields["endian"]);
  if (!is_text && bytes_of(type) > 1 && endian != "little" && endian != "big") {
    throw InputError(subject, "does not state its byte order (endian: little or big)");
  }
  voxels.big_endian = endian == "big";
  set_skip(voxels, count / (1 + voxels.more.size()));
  return voxels;
}

}  // namespace

VolumeHeader read_nrrd_header(const fs::path& path) {
  std::ifstream in = open_regular_file(path.string(), path);
  const Header header = read_header(path.string(), in);
  std::vector<std::string> warnings;
  const Axes axes = axes_of(header.fields);
  const VoxelLayers layers = layers_of(header, axes);
  const GridGeometry geometry = geometry_of(header.fields, axes, warnings);
  return {geometry,
          voxels_of(path, header, std::move(in), geometry.voxel_count() * layers.count),
          std::move(warnings),
          header.key_values,
          !segment_numbers(header.key_values).empty(),
          layers};
}

}  // namespace osteomill
