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

/// Returns how many bytes one voxel takes.
std::uint64_t bytes_of(VoxelType type);

/// The content of a file ahead of its voxels.
struct BeforeVoxels {
  /// Lines of text, then bytes of the file as it is, then unpacked bytes.
  double lines = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t bytes = 0;
  /// True if the voxels are the last that the file holds, whatever comes before them.
  bool are_last = false;
};

/// The voxels of a file, and what its header says of how they are stored.
struct StoredVoxels {
  ByteSource source;
  VoxelType type = VoxelType::int16;
  bool big_endian = false;
  /// One number after the other in decimal digits.
  bool is_text = false;
  /// Bytes of `source` before the voxels.
  std::uint64_t skip = 0;
  /// The length of the compressed data, if the header gives it; else 0.
  std::uint64_t compressed_bytes = 0;
  /// Density = slope * stored value + intercept.
  double slope = 1;
  double intercept = 0;
  /// Files in which the voxels go on behind those of `source`, each laid out as that is and with as many.
  std::vector<std::filesystem::path> more{};
  BeforeVoxels before{};
};

/// Returns a source that begins behind the lines and bytes of the file that come before its voxels.
ByteSource source_behind(std::ifstream in, const BeforeVoxels& before, Packing packing);

/// Sets `skip` by what comes before the voxels, of which the source holds `count`.
void set_skip(StoredVoxels& stored, std::uint64_t count);

/// Reads `count` densities, an equal share of them from each file. Nothing is allocated that the file cannot
/// hold. Throws InputError naming `subject` if the voxels are not all there or damaged, or the densities
/// would take over `max_bytes`; adds a warning if there is more.
std::vector<float> read_voxels(const std::string& subject, StoredVoxels& stored, std::uint64_t count,
                               std::uint64_t max_bytes, std::vector<std::string>& warnings);

/// Layers of a segmentation whose segments may overlap: several values a voxel, along an axis that runs
/// fastest or slowest of all.
struct VoxelLayers {
  std::uint64_t count = 1;
  bool run_fastest = true;
};

/// The header of a volume file, and the voxels behind it, ready to be read.
struct VolumeHeader {
  GridGeometry geometry;
  StoredVoxels voxels;
  std::vector<std::string> warnings;
  /// NRRD's key/value pairs, in which programs keep data that the format has no field for.
  std::map<std::string, std::string> key_values{};
  /// True if the header says so; it need not.
  bool is_labels = false;
  VoxelLayers layers{};
  /// Texts that programs keep beside the header: NIfTI's extensions.
  std::vector<std::string> texts{};
};

/// Each reads the header of a file of its format, and checks that it is of one grey volume, with sizes and
/// spacings above zero and axes at right angles. Throws InputError naming the file.
VolumeHeader read_nrrd_header(const std::filesystem::path& path);
VolumeHeader read_metaimage_header(const std::filesystem::path& path);
VolumeHeader read_nifti_header(const std::filesystem::path& path);

/// One of the formats whose volume lies in one file (or in a header and a file of voxels).
struct VolumeFormat {
  const char* name;
  /// The endings of its files, in small letters.
  std::vector<std::string_view> endings;
  VolumeHeader (*read_header)(const std::filesystem::path& path);
};
/// Returns the format by the ending of the file's name; null if it is none of them. A name that ends in .img
/// is NIfTI only if its header lies beside it.
const VolumeFormat* volume_format_of(const std::filesystem::path& path);

/// Reads what the header is of, layers as one (`merge_layers`). Throws InputError naming `subject`.
std::vector<float> read_volume(const std::string& subject, VolumeHeader& header, std::uint64_t max_bytes);

/// Puts the layers of a segmentation, whose voxels `values` holds, into one map of labels. If a value stands
/// for different segments in two layers, segments are numbered from 1 instead, in the values and in the
/// header's pairs SegmentN_LabelValue. Throws InputError naming `subject` if segments overlap.
std::vector<float> merge_layers(const std::string& subject, std::vector<float> values, VolumeHeader& header);

/// Returns the numbers N of the segments that pairs SegmentN_... describe; as a rule from 0 up.
std::set<int> segment_numbers(const std::map<std::string, std::string>& key_values);

/// Returns the header of a file of voxels by its name, as a.hdr of a.img; nothing for any other file.
std::optional<std::filesystem::path> header_of_voxels(const std::filesystem::path& path);

/// Throws InputError naming the file.
Scan read_volume_file(const std::filesystem::path& path, const VolumeFormat& format,
                      const ReadOptions& options);

/// The fields of a header that is text, by their names. Errors are InputErrors that name `subject`.
struct HeaderFields {
  std::string subject;
  std::map<std::string, std::string> values{};

  bool has(const std::string& name) const { return values.contains(name); }
  /// Empty if there is none.
  std::string operator[](const std::string& name) const {
    return has(name) ? values.at(name) : std::string();
  }
  /// Throws if there are none.
  std::vector<double> numbers(const std::string& name) const;
  /// A number of bytes or lines, not less than `min`; 0 if the field is not there. Throws if it is
  /// anything else.
  double count(const std::string& name, double min) const;
};

/// Returns the files that hold the voxels, by what the header in the file `path` says of them: one name,
/// "LIST" with a name in each further line of the header, or a pattern with its first and last number and the
/// step between numbers, as "slice%03d.raw 1 24 1". Names are relative to the header's folder. Throws
/// InputError naming `subject`.
std::vector<std::filesystem::path> data_files(const std::string& subject, const std::filesystem::path& path,
                                              const std::string& said, std::istream& header);

/// The greatest cosine of an angle between two columns, 0 for axes at right angles; and how large it may be
/// without a word: so much comes of numbers that are written with few digits.
double most_skew(const Mat3& axes);
inline constexpr double kNoShear = 1e-3;

/// A grid by what headers say of it, checked: sizes are three whole numbers above zero whose product can be a
/// volume; the columns of `axes`, of which only the direction counts, are not zero and at right angles, or
/// put so, with a warning, where they are less than a quarter of a degree off; spacings are finite, above
/// zero and, like the origin, those of a bone (`check_plausible`). `unit_mm`: the millimetres in the unit of
/// spacing and origin. `lps_from_axes`: the signs that turn the file's frame into LPS.
GridGeometry checked_geometry(const std::string& subject, const std::vector<double>& sizes,
                              const std::vector<double>& spacing, const Mat3& axes, const Vec3& origin,
                              double unit_mm, std::vector<std::string>& warnings,
                              const Vec3& lps_from_axes = Vec3::Ones());

/// Three finite numbers; throws InputError, calling them `name`, if they are not.
Vec3 checked_point(const std::string& subject, const std::string& name, const std::vector<double>& numbers);

/// Millimetres in a unit of length as headers name it ("mm", "um", ...); throws InputError if it is not
/// known.
double millimetres_in(const std::string& subject, std::string_view unit);

}  // namespace osteomill
