#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Set of voxels of a scan, one bit per voxel of a box.
class VoxelSet {
 public:
  VoxelSet() = default;
  /// Makes an empty set for voxels of this box.
  explicit VoxelSet(const VoxelBox& box) : box_(box) {
    if (box_.empty()) return;
    dims_ = box_.dims();
    bits_.resize(cell_count(dims_));
  }

  const VoxelBox& box() const { return box_; }
  bool contains(const VoxelIndex& v) const { return box_.contains(v) && bits_[place_of(v)]; }
  std::size_t count() const { return static_cast<std::size_t>(std::ranges::count(bits_, true)); }
  bool empty() const { return std::ranges::find(bits_, true) == bits_.end(); }
  /// `v` must be in the box.
  void insert(const VoxelIndex& v) { bits_[place_of(v)] = true; }

  /// Calls `use` with every voxel of the set, i fastest.
  template <typename Use>
  void for_each(const Use& use) const {
    osteomill::for_each(box_, [&](const VoxelIndex& v) {
      if (bits_[place_of(v)]) use(v);
    });
  }

 private:
  std::size_t place_of(const VoxelIndex& v) const {
    return row_major(dims_, v.i - box_.first.i, v.j - box_.first.j, v.k - box_.first.k);
  }

  VoxelBox box_;
  std::array<int, 3> dims_{0, 0, 0};
  std::vector<bool> bits_;
};

}  // namespace osteomill
