#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "osteomill/ct/byte_source.h"

namespace osteomill {

enum class VoxelType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

/// How many bytes one voxel takes.
std::uint64_t bytes_of(VoxelType type);

/// The voxels of a file, and what its header says of how they are stored.
struct StoredVoxels {
  ByteSource source;
  VoxelType type = VoxelType::int16;
  bool big_endian = false;
  /// One number after the other in decimal digits.
  bool is_text = false;
  /// Bytes of `source` before the voxels.
  std::uint64_t skip = 0;
  /// How long the header says that the compressed data are; 0 where it does not say.
  std::uint64_t compressed_bytes = 0;
  /// Density = slope * stored value + intercept.
  double slope = 1;
  double intercept = 0;
};

/// Has the voxels be the last `count` of what there is.
void skip_to_last(StoredVoxels& stored, std::uint64_t count);

/// Reads `count` densities. Nothing is allocated that the file cannot hold. Throws InputError naming
/// `subject` where the voxels are not all there or damaged, or the densities would take over `max_bytes`;
/// adds a warning where there is more.
std::vector<float> read_voxels(const std::string& subject, StoredVoxels& stored, std::uint64_t count,
                               std::uint64_t max_bytes, std::vector<std::string>& warnings);

}  // namespace osteomill
