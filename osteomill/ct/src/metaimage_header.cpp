// MetaImage, https://itk.org/Wiki/ITK/MetaIO/Documentation
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "osteomill/base/input_error.h"

#include "header_text.h"
#include "volume_file.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxHeader = 1 << 20;

bool is_true(const HeaderFields& fields, const std::string& name) {
  const std::string value = fields[name];
  return !value.empty() && (value[0] == 'T' || value[0] == 't' || value[0] == '1');
}

// Returns the first of several synonymous names that is present.
std::string first_of(const HeaderFields& fields, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (fields.has(name)) return name;
  }
  return {};
}

// Names as ITK writes them; other programs may use another case.
constexpr std::array kNames{"NDims",
                            "DimSize",
                            "ElementSpacing",
                            "ElementSize",
                            "TransformMatrix",
                            "Rotation",
                            "Orientation",
                            "Offset",
                            "Position",
                            "Origin",
                            "DistanceUnits",
                            "ElementType",
                            "BinaryData",
                            "CompressedData",
                            "CompressedDataSize",
                            "ElementNumberOfChannels",
                            "HeaderSize",
                            "ElementByteOrderMSB",
                            "BinaryDataByteOrderMSB",
                            "ElementDataFile"};

// The header ends with the line that names the data file; the other fields may be in any order. Like ITK,
// ignores empty lines, lines without a field, and unknown fields.
HeaderFields read_fields(const std::string& subject, std::istream& in) {
  HeaderFields fields{subject};
  std::string line;
  std::size_t length = 0;
  while (!fields.has("ElementDataFile") && std::getline(in, line)) {
    length += line.size() + 1;
    if (length > kMaxHeader || line.find('\0') != std::string::npos) {
      throw InputError(subject, "is not MetaImage: its header has no lines \"name = value\"");
    }
    const std::size_t separator = line.find_first_of("=:");
    if (separator == std::string::npos) continue;
    const std::string name = lower(trimmed(std::string_view(line).substr(0, separator)));
    const auto known =
        std::find_if(kNames.begin(), kNames.end(), [&](const char* one) { return lower(one) == name; });
    if (known != kNames.end()) fields.values[*known] = trimmed(std::string_view(line).substr(separator + 1));
  }
  if (fields.values.empty())
    throw InputError(subject, "is not MetaImage: its header has no lines \"name = value\"");
  if (!fields.has("ElementDataFile"))
    throw InputError(subject, "does not name its data file (ElementDataFile)");
  return fields;
}

VoxelType type_of(const std::string& subject, const std::string& type) {
  using enum VoxelType;
  // MET_LONG has 4 bytes in files, on any machine.
  static const std::map<std::string, VoxelType> kTypes{
      {"met_char", int8},       {"met_uchar", uint8},       {"met_short", int16},   {"met_ushort", uint16},
      {"met_int", int32},       {"met_uint", uint32},       {"met_long", int32},    {"met_ulong", uint32},
      {"met_long_long", int64}, {"met_ulong_long", uint64}, {"met_float", float32}, {"met_double", float64}};
  const auto found = kTypes.find(lower(type));
  if (found == kTypes.end()) {
    throw InputError(subject, fmt::format("has voxels of type \"{}\", which is not supported", type));
  }
  return found->second;
}

// Returns the first three of `count` numbers.
std::vector<double> first_three(const HeaderFields& fields, const std::string& name, std::size_t count) {
  std::vector<double> numbers = fields.numbers(name);
  if (numbers.size() != count)
    throw InputError(fields.subject,
                     fmt::format("has a {} of {} numbers, not {}", name, numbers.size(), count));
  numbers.resize(3);
  return numbers;
}

// Returns the first three columns of a square matrix, whose first three dimensions are spatial.
Mat3 axes_of(const HeaderFields& fields, const std::string& name, std::size_t dimensions) {
  const std::vector<double> values = fields.numbers(name);
  if (values.size() != dimensions * dimensions) {
    throw InputError(fields.subject,
                     fmt::format("has a {} that is not {} numbers", name, dimensions * dimensions));
  }
  Mat3 axes;
  for (std::size_t axis = 0; axis < 3; ++axis)
    axes.col(static_cast<Eigen::Index>(axis)) = Vec3(values.data() + axis * dimensions);
  if (((axes.colwise().norm().array() - 1).abs() < 0.01).count() != 3)
    throw InputError(fields.subject, fmt::format("has a {} whose columns are not of length 1", name));
  return axes;
}

GridGeometry geometry_of(const HeaderFields& fields, std::vector<std::string>& warnings) {
  const std::string& subject = fields.subject;
  const double dimensions = fields.numbers("NDims").front();
  if (!(dimensions >= 3 && dimensions <= 10) || dimensions != std::floor(dimensions))
    throw InputError(subject, fmt::format("is not a volume: NDims is {}, not 3", dimensions));
  const auto count = static_cast<std::size_t>(dimensions);
  const std::vector<double> all_sizes = fields.numbers("DimSize"),
                            sizes = first_three(fields, "DimSize", count);
  for (std::size_t axis = 3; axis < count; ++axis) {
    if (all_sizes[axis] != 1)
      throw InputError(subject,
                       fmt::format("holds {} volumes or values per voxel, not one", all_sizes[axis]));
  }
  const std::string spacing = first_of(fields, {"ElementSpacing", "ElementSize"});
  if (spacing.empty()) warnings.push_back("has no voxel size; 1 mm was assumed");
  const std::string matrix = first_of(fields, {"TransformMatrix", "Rotation", "Orientation"});
  const std::string origin = first_of(fields, {"Offset", "Position", "Origin"});
  return checked_geometry(
      subject, sizes, spacing.empty() ? std::vector<double>{1, 1, 1} : first_three(fields, spacing, count),
      matrix.empty() ? Mat3(Mat3::Identity()) : axes_of(fields, matrix, count),
      origin.empty() ? Vec3(Vec3::Zero())
                     : checked_point(subject, origin, first_three(fields, origin, count)),
      millimetres_in(subject, lower(fields["DistanceUnits"])), warnings);
}

void check_grey(const HeaderFields& fields) {
  if (fields.has("ElementNumberOfChannels") && fields.numbers("ElementNumberOfChannels").front() != 1) {
    throw InputError(fields.subject, "is not a grey volume: it has several values per voxel");
  }
}

StoredVoxels voxels_of(const fs::path& path, const HeaderFields& fields, std::ifstream header,
                       std::uint64_t count) {
  const VoxelType type = type_of(fields.subject, fields["ElementType"]);
  const std::string name = fields["ElementDataFile"];
  const bool is_text = fields.has("BinaryData") && !is_true(fields, "BinaryData");
  const Packing packing = is_true(fields, "CompressedData") ? Packing::gzip_or_zlib : Packing::none;
  const double header_size = fields.count("HeaderSize", -1);
  BeforeVoxels before;
  // Counted from the start of the data file.
  if (header_size > 0) before.file_bytes = static_cast<std::uint64_t>(header_size);
  before.are_last = header_size < 0 && packing == Packing::none && !is_text;
  std::vector<fs::path> files;
  if (lower(name) != "local") {
    files = data_files(fields.subject, path, name, header);
    header = open_regular_file(fields.subject, files.front());
    files.erase(files.begin());
  }
  StoredVoxels voxels{.source = source_behind(std::move(header), before, packing),
                      .type = type,
                      .is_text = is_text,
                      .more = std::move(files),
                      .before = before};
  voxels.big_endian = is_true(fields, "BinaryDataByteOrderMSB") || is_true(fields, "ElementByteOrderMSB");
  if (packing != Packing::none && voxels.more.empty())
    voxels.compressed_bytes = static_cast<std::uint64_t>(fields.count("CompressedDataSize", 1));
  set_skip(voxels, count / (1 + voxels.more.size()));
  return voxels;
}

}  // namespace

VolumeHeader read_metaimage_header(const fs::path& path) {
  const std::string subject = path.string();
  std::ifstream in = open_regular_file(subject, path);
  const HeaderFields fields = read_fields(subject, in);
  std::vector<std::string> warnings;
  const GridGeometry geometry = geometry_of(fields, warnings);
  check_grey(fields);
  return {geometry, voxels_of(path, fields, std::move(in), geometry.voxel_count()), std::move(warnings)};
}

}  // namespace osteomill
