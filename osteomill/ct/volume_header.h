#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// What the header of a volume file says, as far as the library that reads the voxels leaves it unchecked.
struct VolumeHeader {
  std::array<int, 3> dims{0, 0, 0};
  /// Length of the header's unit of length.
  double unit_mm = 1;
  /// Where the format's own rules place the grid; otherwise the reading library's word is taken.
  std::optional<GridGeometry> geometry;
  /// What ITK adds to every value against the format's rules.
  double added_by_itk = 0;
  std::vector<std::string> warnings;
};

/// These read the header of one file each and check that its data are all there: no more is promised than the
/// file holds, sizes and spacings are numbers above zero, the axes are at right angles, it is one grey
/// volume. Throw InputError naming the file.
VolumeHeader check_nrrd(const std::filesystem::path& path);
VolumeHeader check_metaimage(const std::filesystem::path& path);
VolumeHeader check_nifti(const std::filesystem::path& path);

/// Where the voxels of a volume are kept, and how many bytes they take.
struct StoredVoxels {
  std::filesystem::path file;
  std::uint64_t offset = 0;
  std::uint64_t bytes = 0;
  bool compressed = false;
  /// How long the header says that the compressed data are; 0 where it does not say.
  std::uint64_t compressed_bytes = 0;
  /// Bytes before the voxels that are compressed with them.
  std::uint64_t compressed_skip = 0;
};

/// Throws InputError naming `subject` where the voxels are not all there; returns a warning where there is
/// more.
std::vector<std::string> check_stored(const std::string& subject, const StoredVoxels& stored);

/// Three whole numbers above zero, whose product can be a volume.
std::array<int, 3> checked_dims(const std::string& subject, const std::vector<double>& sizes);

/// Three distances, finite and above zero.
void check_spacing(const std::string& subject, const std::vector<double>& spacing);

/// Three axes, one a column, as long as the voxels: neither zero nor skew.
void check_axes(const std::string& subject, const Mat3& axes);

/// Millimetres in a unit of length as headers name it ("mm", "um", ...); throws InputError where it is not
/// known.
double millimetres_in(const std::string& subject, std::string_view unit);

}  // namespace osteomill
