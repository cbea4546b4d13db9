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

/// The bone: densities, the isovalue (bone is density > isovalue), and the density range of each brick.
/// Invariant: densities never rise and the isovalue is constant; code that updates its data from tick to tick
/// relies on this. `EditableVolume` may break it while no session uses the bone. Only the haptic thread
/// lowers densities; other threads read copies, which take memory only for their changes.
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
  /// Returns the map of the bone's structures; null if there is none. Shared by copies of the bone.
  const std::shared_ptr<const LabelMap>& labels() const { return labels_; }
  /// Sets the map, which must be on this grid. Not for the tick.
  void set_labels(std::shared_ptr<const LabelMap> labels) { labels_ = std::move(labels); }
  /// Returns the structures whose distance is recorded in every tick; null if there are none. Shared by
  /// copies of the bone.
  const std::shared_ptr<const NoGoDistances>& no_go() const { return no_go_; }
  /// Sets the structures. Not for the tick.
  void set_no_go(std::shared_ptr<const NoGoDistances> structures) { no_go_ = std::move(structures); }

  /// Returns whether voxel `v`, which must be in the grid, is bone.
  bool is_bone(const VoxelIndex& v) const noexcept { return static_cast<double>(grid_[v]) > isovalue_; }
  /// Returns whether voxel `v` is bone; false if it is not in the grid.
  bool is_bone_in_grid(const VoxelIndex& v) const noexcept { return grid_.contains(v) && is_bone(v); }

  /// Lowers the densities of `count` voxels of one row, columns ascending. Ignores densities that are not
  /// below the current ones. Safe in the haptic tick.
  void lower_row(int j, int k, const int* columns, const float* densities, std::size_t count) noexcept {
    for (std::size_t n = 0; n < count; ++n) {
      const VoxelIndex v{columns[n], j, k};
      if (densities[n] < grid_[v]) set(v, densities[n]);
    }
    ranges_.lower_row(j, k, columns, densities, count);
  }
  /// Lowers the density of one voxel. Safe in the haptic tick.
  void lower_density(const VoxelIndex& v, float density) noexcept { lower_row(v.j, v.k, &v.i, &density, 1); }
  /// Pre-faults memory for upcoming changes (DensityGrid::prefault_around). To be called from another thread
  /// than the one that lowers densities, if that one must not wait.
  void prefault_around(const VoxelBox& changed) { grid_.prefault_around(changed); }
  /// Returns a hash of the changes since construction: 0 if there are none, and equal for equal bones of one
  /// scan, whatever the order in which they were milled. Safe in the haptic tick.
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

/// Calls `visit` with every bone voxel, i fastest; skips bricks without bone. Long work (WorkProgress).
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

/// Change made by one milling step (BurrMill): a box that contains every voxel whose density fell; empty if
/// none did.
struct VolumeChange {
  VoxelBox voxels;
};

}  // namespace osteomill
