#pragma once

#include <cstdint>
#include <vector>

#include "osteomill/volume/voxel_set.h"

namespace osteomill {

/// Nearest voxel of a set for each voxel of a box: the exact Euclidean feature transform of Felzenszwalb and
/// Huttenlocher (Theory of Computing 8, 2012), axis by axis.
class NearestVoxels {
 public:
  /// Point of a voxel of the set to which distances are measured: its centre, or the nearest point of its
  /// faces.
  enum class To : unsigned char { centres, faces };

  NearestVoxels() = default;
  /// Uses only the voxels of `set` that are in `box`. Throws std::invalid_argument if the box has 2^31 voxels
  /// or more. Long work.
  NearestVoxels(const VoxelSet& set, const VoxelBox& box, const Vec3& spacing_mm, To to = To::centres);

  const VoxelBox& box() const { return box_; }
  /// Returns whether the box contains any voxel of the set.
  bool found() const { return found_; }
  /// Returns the voxel of the set nearest to `v`. `v` must be in the box, and found() true. Safe in the
  /// haptic tick.
  VoxelIndex nearest_to(const VoxelIndex& v) const noexcept;
  /// Returns the distance from the centre of `v` to that of the nearest voxel; infinite if found() is false.
  /// Safe in the haptic tick.
  double distance_mm(const VoxelIndex& v) const noexcept;

 private:
  void sweep(std::size_t axis, To to, std::vector<float>& squares_mm2);

  VoxelBox box_;
  std::array<int, 3> dims_{0, 0, 0};
  Vec3 spacing_mm_ = Vec3::Ones();
  bool found_ = false;
  // Linear index in the box of the nearest voxel, per voxel of the box; -1 if there is none.
  std::vector<std::int32_t> nearest_;
};

}  // namespace osteomill
