#pragma once

#include "osteomill/numbers/row_major.h"
#include "osteomill/volume/copy_on_write_floats.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// The densities of a scan, one float a voxel (Hounsfield units where the scan has them), i running fastest.
/// Outside the grid there is nothing: every voxel there counts as `outside_density()`. Copies share what was
/// changed in neither. Reading is safe in the haptic tick; one thread writes.
class DensityGrid {
 public:
  DensityGrid() = default;
  /// `densities` has `geometry.voxel_count()` values, all finite (the readers see to that).
  DensityGrid(const GridGeometry& geometry, CopyOnWriteFloats densities);

  const GridGeometry& geometry() const { return geometry_; }
  const CopyOnWriteFloats& densities() const { return densities_; }
  /// The least density of the grid as it was made.
  float outside_density() const { return outside_density_; }

  std::size_t linear_index(const VoxelIndex& v) const { return row_major(geometry_.dims, v.i, v.j, v.k); }
  bool contains(const VoxelIndex& v) const {
    return v.i >= 0 && v.j >= 0 && v.k >= 0 && v.i < geometry_.dims[0] && v.j < geometry_.dims[1] &&
           v.k < geometry_.dims[2];
  }
  /// `v` must lie in the grid.
  float operator[](const VoxelIndex& v) const { return densities_[linear_index(v)]; }
  /// Any `v`; the outside density beyond the border.
  float at_or_outside(const VoxelIndex& v) const {
    return contains(v) ? densities_[linear_index(v)] : outside_density_;
  }
  /// Asks for the voxel's cache line ahead of reading it. `v` must lie in the grid.
  void prefetch(const VoxelIndex& v) const {
#ifdef __GNUC__
    __builtin_prefetch(densities_.data() + linear_index(v));
#else
    (void)v;
#endif
  }
  void set(const VoxelIndex& v, float density) {
    densities_.set(linear_index(v), density);
  }
  /// Has the memory for changes about `changed` made before they come (CopyOnWriteFloats::prepare): as far as
  /// a burr may go on from there in some tens of milliseconds.
  void prepare_about(const VoxelBox& changed);

 private:
  GridGeometry geometry_;
  CopyOnWriteFloats densities_;
  VoxelBox prepared_;
  float outside_density_ = 0;
};

}  // namespace osteomill
