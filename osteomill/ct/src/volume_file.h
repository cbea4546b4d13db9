#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/ct/read_scan.h"
#include "osteomill/volume/grid_geometry.h"

#include "byte_source.h"

namespace osteomill {

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// Returns the size of one voxel, bytes.
std::uint64_t bytes_of(VoxelType type);

/// Content of a file before its voxels.
struct BeforeVoxels {
  /// Lines of text to skip, then bytes of the file as stored, then decompressed bytes.
  double lines = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t bytes = 0;
  /// True if the voxels are at the end of the file, whatever precedes them.
  bool are_last = false;
};

/// Voxels of a file, and how they are stored according to the header.
struct StoredVoxels {
  ByteSource source;
  VoxelType type = VoxelType::int16;
  bool big_endian = false;
  /// True for text: decimal numbers one after the other.
  bool is_text = false;
  /// Bytes of `source` before the voxels.
  std::uint64_t skip = 0;
  /// Length of the compressed data if the header states it; otherwise 0.
  std::uint64_t compressed_bytes = 0;
  /// Density = slope * stored value + intercept.
  double slope = 1;
  double intercept = 0;
  /// Further files that continue the voxels of `source`, each with the same layout and number of voxels.
  std::vector<std::filesystem::path> more{};
  BeforeVoxels before{};
};

/// Returns a source that starts after the lines and file bytes in `before`.
ByteSource source_behind(std::ifstream in, const BeforeVoxels& before, Packing packing);

/// Sets `skip` from `before`, given that the source holds `count` voxels.
void set_skip(StoredVoxels& stored, std::uint64_t count);

/// Reads `count` densities, the same number from each file. Allocates no more than the file can hold. Throws
/// InputError, naming `subject`, if voxels are missing or damaged, or the densities would need more than
/// `max_bytes`; adds a warning if there are more data.
std::vector<float> read_voxels(const std::string& subject, StoredVoxels& stored, std::uint64_t count,
                               std::uint64_t max_bytes, std::vector<std::string>& warnings);

/// Layers of a segmentation whose segments may overlap: several values per voxel, along the fastest or the
/// slowest axis.
struct VoxelLayers {
  std::uint64_t count = 1;
  bool run_fastest = true;
};

/// Header of a volume file, and its voxels, ready to be read.
struct VolumeHeader {
  GridGeometry geometry;
  StoredVoxels voxels;
  std::vector<std::string> warnings;
  /// Key/value pairs of NRRD, for data without a field in the format.
  std::map<std::string, std::string> key_values{};
  /// True if the header declares labels, which is optional.
  bool is_labels = false;
  VoxelLayers layers{};
  /// Texts of NIfTI's extensions.
  std::vector<std::string> texts{};
};

/// Reads the header of a file and checks that it describes one grey volume with sizes and spacings above zero
/// and orthogonal axes. Throws InputError, naming the file.
VolumeHeader read_nrrd_header(const std::filesystem::path& path);
VolumeHeader read_metaimage_header(const std::filesystem::path& path);
VolumeHeader read_nifti_header(const std::filesystem::path& path);

/// Format that stores a volume in one file, or in a header and data files.
struct VolumeFormat {
  const char* name;
  /// File name endings, in lower case.
  std::vector<std::string_view> endings;
  VolumeHeader (*read_header)(const std::filesystem::path& path);
};
/// Returns the format by the file's name; null if unknown. A file named .img is NIfTI only if its header is
/// in the same folder.
const VolumeFormat* volume_format_of(const std::filesystem::path& path);

/// Reads the header's voxels and merges their layers (`merge_layers`). Throws InputError, naming `subject`.
std::vector<float> read_volume(const std::string& subject, VolumeHeader& header, std::uint64_t max_bytes);

/// Merges the layers of a segmentation with voxels `values` into one label map. If two layers use the same
/// value for different segments, renumbers the segments from 1, in the values and in the header's pairs
/// SegmentN_LabelValue. Throws InputError, naming `subject`, if segments overlap.
std::vector<float> merge_layers(const std::string& subject, std::vector<float> values, VolumeHeader& header);

/// Returns the numbers N for which there are pairs SegmentN_...; usually from 0 up.
std::set<int> segment_numbers(const std::map<std::string, std::string>& key_values);

/// Returns the existing header of a voxel file by its name (a.hdr for a.img); nullopt if there is none.
std::optional<std::filesystem::path> header_of_voxels(const std::filesystem::path& path);

/// Throws InputError naming the file.
Scan read_volume_file(const std::filesystem::path& path, const VolumeFormat& format,
                      const ReadOptions& options);

/// Fields of a text header by name. Errors are InputErrors that name `subject`.
struct HeaderFields {
  std::string subject;
  std::map<std::string, std::string> values{};

  bool has(const std::string& name) const { return values.contains(name); }
  /// Returns the field's value; empty if missing.
  std::string operator[](const std::string& name) const {
    return has(name) ? values.at(name) : std::string();
  }
  /// Returns the field's numbers. Throws if there are none.
  std::vector<double> numbers(const std::string& name) const;
  /// Returns a number of bytes or lines, at least `min`; 0 if the field is missing. Throws for any other
  /// value.
  double count(const std::string& name, double min) const;
};

/// Returns the data files that the header in `path` names by `said`: one name; "LIST", with one name per
/// further line of the header; or a pattern with its first and last number and the step, such as
/// "slice%03d.raw 1 24 1". Names are relative to the header's folder. Throws InputError, naming `subject`.
std::vector<std::filesystem::path> data_files(const std::string& subject, const std::filesystem::path& path,
                                              const std::string& said, std::istream& header);

/// Returns the largest absolute cosine between two columns; 0 for orthogonal axes. Up to kNoShear it is
/// accepted without a warning, as rounding of numbers with few digits.
double max_skew(const Mat3& axes);
inline constexpr double kNoShear = 1e-3;

/// Makes a grid from header values and checks them. Sizes must be three whole numbers above zero with a
/// plausible product. The columns of `axes`, of which only the direction is used, must not be zero and must
/// be orthogonal; if less than a quarter of a degree off, they are orthogonalised with a warning. Spacing and
/// origin must be plausible for a bone (`check_plausible`). `unit_mm` is the unit of spacing and origin in
/// mm. `lps_from_axes` holds the signs that convert the file's frame to LPS. Throws InputError, naming
/// `subject`.
GridGeometry checked_geometry(const std::string& subject, const std::vector<double>& sizes,
                              const std::vector<double>& spacing, const Mat3& axes, const Vec3& origin,
                              double unit_mm, std::vector<std::string>& warnings,
                              const Vec3& lps_from_axes = Vec3::Ones());

/// Returns a point of three finite numbers; otherwise throws InputError, calling them `name`.
Vec3 checked_point(const std::string& subject, const std::string& name, const std::vector<double>& numbers);

/// Returns a unit of length of a header ("mm", "um", ...) in mm; throws InputError if it is unknown.
double millimetres_in(const std::string& subject, std::string_view unit);

}  // namespace osteomill
