// MetaImage, https://itk.org/Wiki/ITK/MetaIO/Documentation
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

// The first of several names for the same thing.
std::string first_of(const HeaderFields& fields, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    if (fields.has(name)) return name;
  }
  return {};
}

// The header ends with the line that names the data.
HeaderFields read_fields(const std::string& subject, std::istream& in) {
  HeaderFields fields{subject};
  std::string line;
  std::size_t length = 0;
  while (!fields.has("ElementDataFile") && std::getline(in, line)) {
    length += line.size();
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos || length > kMaxHeader || line.find('\0') != std::string::npos) {
      throw InputError(subject, "is not MetaImage: its header is not made of \"name = value\"");
    }
    fields.values[trimmed(std::string_view(line).substr(0, equals))] =
        trimmed(std::string_view(line).substr(equals + 1));
  }
  if (!fields.has("ElementDataFile"))
    throw InputError(subject, "does not say where its data are (ElementDataFile)");
  return fields;
}

VoxelType type_of(const std::string& subject, const std::string& type) {
  using enum VoxelType;
  // MET_LONG is 4 bytes in a file, whatever it is on the machine.
  static const std::map<std::string, VoxelType> kTypes{
      {"MET_CHAR", int8},       {"MET_UCHAR", uint8},       {"MET_SHORT", int16},   {"MET_USHORT", uint16},
      {"MET_INT", int32},       {"MET_UINT", uint32},       {"MET_LONG", int32},    {"MET_ULONG", uint32},
      {"MET_LONG_LONG", int64}, {"MET_ULONG_LONG", uint64}, {"MET_FLOAT", float32}, {"MET_DOUBLE", float64}};
  const auto found = kTypes.find(type);
  if (found == kTypes.end()) {
    throw InputError(subject, fmt::format("has voxels of type \"{}\", which is not supported", type));
  }
  return found->second;
}

GridGeometry geometry_of(const HeaderFields& fields, std::vector<std::string>& warnings) {
  const std::string& subject = fields.subject;
  if (fields.numbers("NDims").front() != 3) throw InputError(subject, "is not a volume: NDims is not 3");
  const std::string spacing = first_of(fields, {"ElementSpacing", "ElementSize"});
  if (spacing.empty()) warnings.push_back("does not say how large its voxels are; 1 mm was assumed");
  Mat3 axes = Mat3::Identity();
  const std::string matrix = first_of(fields, {"TransformMatrix", "Rotation", "Orientation"});
  if (!matrix.empty()) {
    const std::vector<double> values = fields.numbers(matrix);
    if (values.size() != 9)
      throw InputError(subject, fmt::format("has a {} that is not nine numbers", matrix));
    axes = Eigen::Map<const Mat3>(values.data());
    if (((axes.colwise().norm().array() - 1).abs() < 0.01).count() != 3)
      throw InputError(subject, fmt::format("has a {} whose columns are not of length 1", matrix));
  }
  const std::string origin = first_of(fields, {"Offset", "Position", "Origin"});
  return checked_geometry(
      subject, fields.numbers("DimSize"),
      spacing.empty() ? std::vector<double>{1, 1, 1} : fields.numbers(spacing), axes,
      origin.empty() ? Vec3::Zero() : checked_point(subject, origin, fields.numbers(origin)),
      millimetres_in(subject, lower(fields["DistanceUnits"])));
}

void check_grey(const HeaderFields& fields) {
  if (fields.has("ElementNumberOfChannels") && fields.numbers("ElementNumberOfChannels").front() != 1) {
    throw InputError(fields.subject, "is not a grey volume: it holds several values a voxel");
  }
  if (fields.has("BinaryData") && !is_true(fields, "BinaryData")) {
    throw InputError(fields.subject, "holds its voxels as text, which is not supported");
  }
}

StoredVoxels voxels_of(const fs::path& path, const HeaderFields& fields, std::ifstream header,
                       std::uint64_t count) {
  const VoxelType type = type_of(fields.subject, fields["ElementType"]);
  const std::string name = fields["ElementDataFile"];
  const bool local = lower(name) == "local";
  const bool packed = is_true(fields, "CompressedData");
  std::ifstream data = open_data(fields.subject, path, local ? "" : name, std::move(header));
  const double header_size = fields.count("HeaderSize", -1);
  // It counts from the beginning of the file that holds the data.
  if (header_size > 0) data.seekg(static_cast<std::streamoff>(header_size));
  StoredVoxels voxels{.source = ByteSource(std::move(data), packed ? Packing::gzip_or_zlib : Packing::none),
                      .type = type};
  voxels.big_endian = is_true(fields, "BinaryDataByteOrderMSB") || is_true(fields, "ElementByteOrderMSB");
  if (packed) {
    voxels.compressed_bytes = static_cast<std::uint64_t>(fields.count("CompressedDataSize", 1));
  } else if (header_size < 0) {
    skip_to_last(voxels, count);
  }
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
