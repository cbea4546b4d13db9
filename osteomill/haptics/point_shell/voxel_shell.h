#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "osteomill/haptics/bone_points/brick_points.h"
#include "osteomill/haptics/point_shell/bone_bits.h"
#include "osteomill/haptics/point_shell/count_pyramid.h"
#include "osteomill/numbers/row_major.h"
#include "osteomill/volume/volume.h"

namespace osteomill::point_shell {

/// The milled object as a point shell ("MPO", Eriksson 2012, 6.1): the centres of the surface voxels (bone
/// with one of its 6 neighbours not bone), each for the square of its size, in bricks of 8 x 8 x 8 under an
/// octree. Voxels, here nodes, are the scan's or, `scale` times as far apart, sampled anew from it. Building
/// allocates; `refresh` does not, and is safe in the haptic tick.
class VoxelShell {
 public:
  static constexpr int kMaxScale = 32;
  static constexpr int kBrickNodes = 8;

  VoxelShell() = default;
  /// `volume` outlives the shell; `scale` is 1 to `kMaxScale`.
  VoxelShell(const Volume& volume, int scale);

  /// Brings points up to date with densities that fell in `voxels`.
  void refresh(const VoxelBox& voxels);

  const CountPyramid& octree() const { return octree_; }
  const BrickPoints& points() const { return points_; }
  std::uint32_t point_count() const { return octree_.total(); }
  std::size_t brick_index(int bi, int bj, int bk) const { return row_major(octree_.dims(0), bi, bj, bk); }
  /// The origin of a brick's frame in the grid's frame G (the grid's axes, mm, origin at node 0,0,0).
  Vec3 brick_origin_G(int bi, int bj, int bk) const { return brick_side_mm_.cwiseProduct(Vec3(bi, bj, bk)); }
  /// An axis-aligned box of G that holds all points below a node of the octree: middle and half widths.
  struct NodeBox {
    Vec3 middle_G;
    Vec3 half_mm;
  };
  NodeBox node_box(int level, int i, int j, int k) const {
    const double bricks = static_cast<double>(1 << level);
    const Vec3 half = 0.5 * bricks * brick_side_mm_;
    return {half.cwiseProduct(Vec3(2 * i + 1, 2 * j + 1, 2 * k + 1)) - 0.5 * geometry_.spacing_mm, half};
  }
  /// Where G lies in W: points `origin + direction * p_G`.
  const Vec3& origin_W() const { return geometry_.origin_mm; }
  const Mat3& direction() const { return geometry_.direction; }

  /// Calls `f(point_W, area_mm2)` for every point, brick by brick, in the order of the grid. Not for the
  /// tick.
  template <typename F>
  void for_each_point(F&& f) const;

 private:
  // Byte j + 8 k, bit i: whether the node is on the surface.
  using SurfaceMask = std::array<std::uint8_t, kBrickNodes * kBrickNodes>;

  std::uint8_t bone_byte(int byte, int j, int k) const;
  void lower_bone(const VoxelBox& nodes);
  VoxelBox nodes_touched_by(const VoxelBox& voxels) const;
  SurfaceMask mask_of(const VoxelIndex& brick) const;
  void refresh_brick(const VoxelIndex& brick);

  const Volume* volume_ = nullptr;
  int stride_ = 1;
  GridGeometry geometry_;
  float point_area_mm2_ = 0;
  Vec3 brick_side_mm_ = Vec3::Zero();
  // The largest float that is not bone.
  float bone_above_ = 0;
  BoneBits bone_;
  CountPyramid octree_;
  BrickPoints points_;
  std::vector<SurfaceMask> masks_;
  // Room for one brick's points while it is rebuilt.
  PointRows found_{kBrickNodes * kBrickNodes * kBrickNodes};
};

template <typename F>
void VoxelShell::for_each_point(F&& f) const {
  const auto& [columns, rows, slices] = octree_.dims(0);
  for_each(VoxelBox{{0, 0, 0}, {columns - 1, rows - 1, slices - 1}}, [&](const VoxelIndex& b) {
    const Vec3 origin_G = brick_origin_G(b.i, b.j, b.k);
    points_.for_each_of(brick_index(b.i, b.j, b.k), [&](const ShellPoint& p) {
      f(Vec3(origin_W() + direction() * (origin_G + p.position_mm())), static_cast<double>(p.area_mm2));
    });
  });
}

}  // namespace osteomill::point_shell
