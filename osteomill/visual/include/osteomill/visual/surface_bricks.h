#pragma once

#include <array>
#include <cstddef>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Partitions the cells of a grid into the bricks of its surface (16 cells a side, unlike the 8 voxels of
/// BlockRanges and DensityBlock). A cell lies between eight neighbouring voxels and is identified by the one
/// with the smallest indices; cells extend one voxel beyond the grid on all sides, so that the surface is
/// closed where bone touches the border. Bricks are numbered from 0, fastest along i.
class SurfaceBricks {
 public:
  /// Cells along each brick edge. The first brick along an axis also has the cell before voxel 0.
  static constexpr int kBrickCells = 16;

  SurfaceBricks() = default;
  explicit SurfaceBricks(const std::array<int, 3>& voxel_dims);

  const std::array<int, 3>& dims() const { return dims_; }
  std::size_t count() const { return cell_count(dims_); }
  std::size_t index(int bi, int bj, int bk) const { return row_major(dims_, bi, bj, bk); }
  std::array<int, 3> coordinates(std::size_t brick) const;

  /// Returns the cells of a brick, each identified by its smallest voxel, whose indices may be -1.
  VoxelBox cells(std::size_t brick) const;
  /// Returns the range of bricks whose triangles, normals or densities depend on a voxel of `voxels` (in the
  /// grid); empty for an empty box.
  VoxelBox bricks_depending_on(const VoxelBox& voxels) const;

 private:
  std::array<int, 3> voxel_dims_{0, 0, 0};
  std::array<int, 3> dims_{0, 0, 0};
};

}  // namespace osteomill
