#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <utility>

#include "osteomill/volume/block_ranges.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/label_map.h"
#include "osteomill/volume/structure_distance.h"

namespace osteomill {

/// The bone as every room sees it: densities, the isovalue that bounds the bone (bone where density >
/// isovalue), and the range of densities brick by brick. Densities fall and never rise, and the isovalue
/// stays: all that follows a bone from tick to tick rests on that. `EditableVolume` changes a bone that
/// nothing follows. The haptic thread alone lowers densities; all others read copies, which take memory only
/// for what is changed in them.
class Volume {
 public:
  /// Throws std::invalid_argument if the isovalue is not finite.
  Volume(DensityGrid grid, double isovalue) : grid_(std::move(grid)), ranges_(grid_) {
    set_isovalue(isovalue);
  }

  const DensityGrid& grid() const { return grid_; }
  const GridGeometry& geometry() const { return grid_.geometry(); }
  const BlockRanges& ranges() const { return ranges_; }
  double isovalue() const { return isovalue_; }
  /// Returns the map of the structures that the bone is made of; null if there is none. Copies of the bone
  /// share it.
  const std::shared_ptr<const LabelMap>& labels() const { return labels_; }
  /// Sets the map, which is of this grid. Not for the tick.
  void set_labels(std::shared_ptr<const LabelMap> labels) { labels_ = std::move(labels); }
  /// Returns the structures whose distance is recorded in every tick; null if there are none. Copies of the
  /// bone share them.
  const std::shared_ptr<const NoGoDistances>& no_go() const { return no_go_; }
  /// Sets them. Not for the tick.
  void set_no_go(std::shared_ptr<const NoGoDistances> structures) { no_go_ = std::move(structures); }

  /// Returns whether voxel `v`, which lies in the grid, is bone.
  bool is_bone(const VoxelIndex& v) const noexcept { return static_cast<double>(grid_[v]) > isovalue_; }
  /// Returns whether any voxel `v` is bone; there is none beyond the border.
  bool is_bone_in_grid(const VoxelIndex& v) const noexcept { return grid_.contains(v) && is_bone(v); }

  /// Lowers the densities of `count` voxels of one row, whose columns ascend. A density that is not below the
  /// voxel's own changes nothing. Safe in the haptic tick.
  void lower_row(int j, int k, const int* columns, const float* densities, std::size_t count) noexcept {
    for (std::size_t n = 0; n < count; ++n) {
      const VoxelIndex v{columns[n], j, k};
      if (densities[n] < grid_[v]) set(v, densities[n]);
    }
    ranges_.lower_row(j, k, columns, densities, count);
  }
  /// Lowers the density of one voxel. Safe in the haptic tick.
  void lower_density(const VoxelIndex& v, float density) noexcept { lower_row(v.j, v.k, &v.i, &density, 1); }
  /// Prepares the memory for coming changes (DensityGrid::prefault_around). For another thread than the
  /// one that lowers, if that one must not wait.
  void prefault_around(const VoxelBox& changed) { grid_.prefault_around(changed); }
  /// Returns a hash of what differs from the densities the bone was made with: 0 if nothing does, and the
  /// same for any two bones of one scan that are the same, in whatever order they were milled. Safe in the
  /// haptic tick.
  std::uint64_t change_hash() const noexcept { return change_hash_; }

 private:
  friend class EditableVolume;

  void set_isovalue(double isovalue) {
    if (!std::isfinite(isovalue)) throw std::invalid_argument("Volume: the isovalue is not finite");
    isovalue_ = isovalue;
  }
  void set(const VoxelIndex& v, float density) noexcept {
    const std::size_t voxel = grid_.linear_index(v);
    change_hash_ += density_hash(voxel, density) - density_hash(voxel, grid_[v]);
    grid_.set(v, density);
  }

  DensityGrid grid_;
  BlockRanges ranges_;
  double isovalue_ = 0;
  std::uint64_t change_hash_ = 0;
  std::shared_ptr<const LabelMap> labels_;
  std::shared_ptr<const NoGoDistances> no_go_;
};

/// Calls `visit` with every bone voxel, i running fastest; passes over bricks without bone. Long work
/// (WorkProgress).
template <typename Visit>
void for_each_bone_voxel(const Volume& volume, const Visit& visit) {
  constexpr int kSide = BlockRanges::kBrickVoxels;
  VoxelBox rows = volume.geometry().all_voxels();
  const int last = std::exchange(rows.last.i, rows.last.i / kSide);
  // Here i counts bricks.
  for_each_with_progress(rows, [&](const VoxelIndex& row) {
    const BlockRanges::Range& range = volume.ranges().at(row.i, row.j / kSide, row.k / kSide);
    if (static_cast<double>(range.max) <= volume.isovalue()) return;
    for (VoxelIndex v{kSide * row.i, row.j, row.k}; v.i <= std::min(last, kSide * row.i + kSide - 1); ++v.i) {
      if (volume.is_bone(v)) visit(v);
    }
  });
}

/// The change that milling made in one step (BurrMill): every voxel whose density fell lies in `voxels`,
/// which is empty if none fell.
struct VolumeChange {
  VoxelBox voxels;
};

}  // namespace osteomill
