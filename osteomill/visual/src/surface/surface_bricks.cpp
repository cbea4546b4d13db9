#include "osteomill/visual/surface_bricks.h"

#include <algorithm>

namespace osteomill {

SurfaceBricks::SurfaceBricks(const std::array<int, 3>& voxel_dims)
    : voxel_dims_(voxel_dims), dims_(GridGeometry{voxel_dims}.all_voxels().bricks(kBrickCells).dims()) {}

std::array<int, 3> SurfaceBricks::coordinates(std::size_t brick) const {
  return cell_at(dims_, brick);
}

VoxelBox SurfaceBricks::cells(std::size_t brick) const {
  const auto first_cell = [](int b) { return b == 0 ? -1 : b * kBrickCells; };
  const auto last_cell = [](int b, int voxels) { return std::min((b + 1) * kBrickCells, voxels) - 1; };
  const auto [bi, bj, bk] = coordinates(brick);
  return {{first_cell(bi), first_cell(bj), first_cell(bk)},
          {last_cell(bi, voxel_dims_[0]), last_cell(bj, voxel_dims_[1]), last_cell(bk, voxel_dims_[2])}};
}

VoxelBox SurfaceBricks::bricks_depending_on(const VoxelBox& voxels) const {
  if (voxels.empty()) return {};
  // The normal and density of a vertex between voxels n and n + 1 depend on voxels n - 2 to n + 3.
  const auto first_brick = [](int v) { return std::max(v - 3, 0) / kBrickCells; };
  const auto last_brick = [](int v, int count) { return std::min((v + 2) / kBrickCells, count - 1); };
  return {{first_brick(voxels.first.i), first_brick(voxels.first.j), first_brick(voxels.first.k)},
          {last_brick(voxels.last.i, dims_[0]), last_brick(voxels.last.j, dims_[1]),
           last_brick(voxels.last.k, dims_[2])}};
}

}  // namespace osteomill
