#pragma once

#include <array>
#include <cstddef>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Deals the cells of a grid out to the bricks in which its surface is kept (16 cells a side; not the 8
/// voxels of BlockRanges and DensityBlock). A cell lies between eight neighbouring voxels and is named by the
/// least of them; cells reach one voxel beyond the grid on all sides, so that the surface is closed where
/// bone touches the border. Bricks are numbered from 0, along i fastest.
class SurfaceBricks {
 public:
  /// Cells along each edge of a brick. The first brick along an axis also has the cell before voxel 0.
  static constexpr int kBrickCells = 16;

  SurfaceBricks() = default;
  explicit SurfaceBricks(const std::array<int, 3>& voxel_dims);

  const std::array<int, 3>& dims() const { return dims_; }
  std::size_t count() const { return cell_count(dims_); }
  std::size_t index(int bi, int bj, int bk) const { return row_major(dims_, bi, bj, bk); }
  std::array<int, 3> coordinates(std::size_t brick) const;

  /// Returns the cells of a brick, each by its least voxel, which may have coordinates of -1.
  VoxelBox cells(std::size_t brick) const;
  /// Returns the bricks, by their coordinates, whose triangles, normals or densities depend on a voxel of
  /// `voxels` (in the grid); empty for an empty box.
  VoxelBox bricks_depending_on(const VoxelBox& voxels) const;

 private:
  std::array<int, 3> voxel_dims_{0, 0, 0};
  std::array<int, 3> dims_{0, 0, 0};
};

}  // namespace osteomill
