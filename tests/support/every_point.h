#pragma once

#include "bone_points/bone_bricks.h"
#include "published/point_shell/voxel_shell.h"

namespace osteomill {

/// For tests. Accepts every node of an octree.
inline BrickTree::EightBits every_node(int, const VoxelIndex&) {
  return 0xff;
}

/// Calls `f(point, origin_G)` for every point of one kind (`bricks.fine()` or `bricks.coarse()`); its
/// position in the grid's frame G is relative to `origin_G`. Builds all bricks.
template <typename F>
void for_each_point(BoneBricks& bricks, const BrickPoints& kind, F&& f) {
  bricks.build_and_visit(every_node, [&](const VoxelIndex& brick, std::uint32_t slot) {
    const Vec3 origin_G = bricks.lattice().brick_origin_G(brick);
    kind.for_each_of(slot, [&](const ShellPoint& point) { f(point, origin_G); });
  });
}

/// Calls `f(point_W, area_mm2)` for every fine point.
template <typename F>
void for_each_point(BoneBricks& bricks, F&& f) {
  const SurfaceLattice& lattice = bricks.lattice();
  for_each_point(bricks, bricks.fine(), [&](const ShellPoint& point, const Vec3& origin_G) {
    f(Vec3(lattice.origin_W() + lattice.direction() * (origin_G + point.position_mm())),
      static_cast<double>(point.area_mm2));
  });
}

/// Calls `f` for every point of a shell of voxels.
template <typename F>
void for_each_point(const point_shell::VoxelShell& shell, F&& f) {
  const auto nowhere = [](const point_shell::VoxelShell::NodeBox&) { return false; };
  shell.visit_bricks(nowhere, [&](std::size_t brick, const Vec3& origin_G) {
    shell.points().for_each_of(brick, [&](const ShellPoint& point) {
      f(Vec3(shell.origin_W() + shell.direction() * (origin_G + point.position_mm())),
        static_cast<double>(point.area_mm2));
    });
  });
}

}  // namespace osteomill
