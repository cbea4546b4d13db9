// MetaImage, https://itk.org/Wiki/ITK/MetaIO/Documentation
#include <algorithm>
#include <fstream>
#include <map>

#include <fmt/format.h>

#include "osteomill/ct/parse_numbers.h"
#include "osteomill/ct/volume_header.h"
#include "osteomill/files/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxHeader = 1 << 20;

struct Fields {
  std::map<std::string, std::string> values;

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

// The header ends with the line that names the data.
Fields read_fields(const std::string& subject, std::istream& in) {
  Fields fields;
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

std::vector<double> numbers(const std::string& subject, const Fields& fields, const std::string& name) {
  const auto values = parse_numbers(fields[name]);
  if (!values || values->empty()) throw InputError(subject, fmt::format("has no {} made of numbers", name));
  return *values;
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

GridGeometry geometry_of(const std::string& subject, const Fields& fields,
                         std::vector<std::string>& warnings) {
  if (numbers(subject, fields, "NDims").front() != 3)
    throw InputError(subject, "is not a volume: NDims is not 3");
  const std::string spacing = fields.first_of({"ElementSpacing", "ElementSize"});
  if (spacing.empty()) warnings.push_back("does not say how large its voxels are; 1 mm was assumed");
  Mat3 axes = Mat3::Identity();
  const std::string matrix = fields.first_of({"TransformMatrix", "Rotation", "Orientation"});
  if (!matrix.empty()) {
    const std::vector<double> values = numbers(subject, fields, matrix);
    if (values.size() != 9)
      throw InputError(subject, fmt::format("has a {} that is not nine numbers", matrix));
    axes = Eigen::Map<const Mat3>(values.data());
    if (((axes.colwise().norm().array() - 1).abs() < 0.01).count() != 3)
      throw InputError(subject, fmt::format("has a {} whose columns are not of length 1", matrix));
  }
  const std::string origin = fields.first_of({"Offset", "Position", "Origin"});
  return checked_geometry(
      subject, numbers(subject, fields, "DimSize"),
      spacing.empty() ? std::vector<double>{1, 1, 1} : numbers(subject, fields, spacing), axes,
      origin.empty() ? Vec3::Zero() : checked_point(subject, origin, numbers(subject, fields, origin)),
      millimetres_in(subject, lower(fields["DistanceUnits"])));
}

void check_grey(const std::string& subject, const Fields& fields) {
  if (fields.has("ElementNumberOfChannels") &&
      numbers(subject, fields, "ElementNumberOfChannels").front() != 1) {
    throw InputError(subject, "is not a grey volume: it holds several values a voxel");
  }
  if (fields.has("BinaryData") && !fields.is_true("BinaryData")) {
    throw InputError(subject, "holds its voxels as text, which is not supported");
  }
}

// A number of bytes, not less than `min`; 0 where the field is not there.
double bytes_in(const std::string& subject, const Fields& fields, const std::string& name, double min) {
  if (!fields.has(name)) return 0;
  const std::vector<double> values = numbers(subject, fields, name);
  if (values.size() != 1 || !(values[0] >= min && values[0] < 1e12))
    throw InputError(subject, fmt::format("has no sensible {}", name));
  return values[0];
}

StoredVoxels voxels_of(const std::string& subject, const fs::path& path, const Fields& fields,
                       std::ifstream header, std::uint64_t count) {
  const VoxelType type = type_of(subject, fields["ElementType"]);
  const std::string name = fields["ElementDataFile"];
  if (name.starts_with("LIST") || name.find('%') != std::string::npos) {
    throw InputError(subject, "keeps its data in several files, which is not supported");
  }
  const bool local = lower(name) == "local";
  const bool packed = fields.is_true("CompressedData");
  std::ifstream data = local ? std::move(header) : open_regular_file(subject, path.parent_path() / name);
  const double header_size = bytes_in(subject, fields, "HeaderSize", -1);
  // It counts from the beginning of the file that holds the data.
  if (header_size > 0) data.seekg(static_cast<std::streamoff>(header_size));
  StoredVoxels voxels{.source = ByteSource(std::move(data), packed ? Packing::gzip_or_zlib : Packing::none),
                      .type = type};
  voxels.big_endian = fields.is_true("BinaryDataByteOrderMSB") || fields.is_true("ElementByteOrderMSB");
  if (packed) {
    voxels.compressed_bytes = static_cast<std::uint64_t>(bytes_in(subject, fields, "CompressedDataSize", 1));
  } else if (header_size < 0) {
    // The voxels are what the data end with.
    const std::uint64_t there = voxels.source.bytes_to_come();
    voxels.skip = there - std::min(there, count * bytes_of(type));
  }
  return voxels;
}

}  // namespace

VolumeHeader read_metaimage_header(const fs::path& path) {
  const std::string subject = path.string();
  std::ifstream in = open_regular_file(subject, path);
  const Fields fields = read_fields(subject, in);
  std::vector<std::string> warnings;
  const GridGeometry geometry = geometry_of(subject, fields, warnings);
  check_grey(subject, fields);
  return {geometry, voxels_of(subject, path, fields, std::move(in), geometry.voxel_count()),
          std::move(warnings)};
}

}  // namespace osteomill
