#pragma once

#include <cstdint>
#include <vector>

#include "osteomill/volume/voxel_set.h"

namespace osteomill {

/// For each voxel of a box, which voxel of a set is nearest to its centre: the exact Euclidean feature
/// transform of Felzenszwalb and Huttenlocher (Theory of Computing 8, 2012), axis by axis.
class NearestVoxels {
 public:
  /// The part of a voxel of the set to which the distance counts: its centre, or the nearest of its faces.
  enum class To : unsigned char { centres, faces };

  NearestVoxels() = default;
  /// Searches among the voxels of `set` that lie in `box`. Long work.
  NearestVoxels(const VoxelSet& set, const VoxelBox& box, const Vec3& spacing_mm, To to = To::centres);

  const VoxelBox& box() const { return box_; }
  /// Returns whether the box holds any voxel of the set.
  bool found() const { return found_; }
  /// Returns the nearest one. `v` lies in the box, which holds one. Safe in the haptic tick.
  VoxelIndex nearest_to(const VoxelIndex& v) const noexcept;
  /// Returns the distance of their centres; infinite if there is none. Safe in the haptic tick.
  double distance_mm(const VoxelIndex& v) const noexcept;

 private:
  void sweep(std::size_t axis, To to, std::vector<float>& squares_mm2);

  VoxelBox box_;
  std::array<int, 3> dims_{0, 0, 0};
  Vec3 spacing_mm_ = Vec3::Ones();
  bool found_ = false;
  // By the place in the box: the place of the nearest voxel, or -1.
  std::vector<std::int32_t> nearest_;
};

}  // namespace osteomill
