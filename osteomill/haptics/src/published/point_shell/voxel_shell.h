#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "osteomill/base/row_major.h"
#include "osteomill/volume/volume.h"

#include "bone_points/brick_points.h"

namespace osteomill::point_shell {

/// One bit per node of a grid: set if it is bone. A byte holds eight nodes of a row. A border of empty bytes
/// all round lets neighbours be read without bounds checks. Safe in the haptic tick.
class BoneBits {
 public:
  BoneBits() = default;
  /// Makes a grid without bone. Every dimension must be at least 1.
  explicit BoneBits(const std::array<int, 3>& dims)
      : dims_{(dims[0] + 7) / 8 + 2, dims[1] + 2, dims[2] + 2}, bytes_(cell_count(dims_)) {}

  /// Nodes 8 * `byte` to 8 * `byte` + 7 of row j of slice k, the first in the lowest bit.
  std::uint8_t byte(int byte, int j, int k) const { return bytes_[index(byte, j, k)]; }
  void set_byte(int byte, int j, int k, std::uint8_t bits) { bytes_[index(byte, j, k)] = bits; }

  /// Returns the bone nodes of that byte that have a 6-neighbour that is not bone.
  std::uint8_t surface_byte(int byte, int j, int k) const {
    const std::size_t here = index(byte, j, k);
    const std::size_t row = row_major(dims_, 0, 1, 0), slice = row_major(dims_, 0, 0, 1);
    const unsigned bone = bytes_[here];
    const unsigned below = (bone << 1) | (bytes_[here - 1] >> 7);
    const unsigned above = (bone >> 1) | (static_cast<unsigned>(bytes_[here + 1]) << 7);
    const unsigned enclosed =
        below & above & bytes_[here - row] & bytes_[here + row] & bytes_[here - slice] & bytes_[here + slice];
    return static_cast<std::uint8_t>(bone & ~enclosed);
  }

 private:
  std::size_t index(int byte, int j, int k) const { return row_major(dims_, byte + 1, j + 1, k + 1); }

  std::array<int, 3> dims_{0, 0, 0};
  std::vector<std::uint8_t> bytes_;
};

/// The milled object as a point shell ("MPO", Eriksson 2012, 6.1): the centres of the surface voxels (bone
/// with a 6-neighbour that is not bone), each representing the square of its size, in bricks of 8 x 8 x 8
/// under an octree. Octree nodes of level n, 2^n bricks along each axis, are implicit: only their boxes are
/// computed. Voxels, here called nodes, are the scan's or, `scale` times as far apart, resampled from it.
/// Building allocates; `refresh` does not, and is safe in the haptic tick.
class VoxelShell {
 public:
  static constexpr int kMaxScale = 32;
  static constexpr int kBrickNodes = 8;

  VoxelShell() = default;
  /// `volume` must outlive the shell; `scale` is 1 to `kMaxScale`.
  VoxelShell(const Volume& volume, int scale);

  /// Updates points after densities fell in `voxels`.
  void refresh(const VoxelBox& voxels);

  const BrickPoints& points() const { return points_; }
  /// Axis-aligned bounding box, in G, of all points below an octree node: centre and half extents.
  struct NodeBox {
    Vec3 middle_G;
    Vec3 half_mm;
  };
  /// Calls `visit(brick, origin_G)` for every brick with points unless its own box or that of an ancestor
  /// `is_apart`. Passes the brick's index in `points` and the origin of its frame in the grid's frame G (the
  /// grid's axes, mm, origin at node 0,0,0). The order is fixed. Safe in the haptic tick.
  template <typename IsApart, typename Visit>
  void visit_bricks(const IsApart& is_apart, const Visit& visit) const {
    if (!masks_.empty()) visit_node(root_level_, {0, 0, 0}, is_apart, visit);
  }
  /// Return the pose of G in W: points are at `origin + direction * p_G`.
  const Vec3& origin_W() const { return geometry_.origin_mm; }
  const Mat3& direction() const { return geometry_.direction; }

 private:
  template <typename IsApart, typename Visit>
  void visit_node(int level, const VoxelIndex& node, const IsApart& is_apart, const Visit& visit) const;
  NodeBox node_box(int level, const VoxelIndex& node) const {
    const Vec3 half = 0.5 * static_cast<double>(1 << level) * brick_side_mm_;
    const Vec3 middle(2 * node.i + 1, 2 * node.j + 1, 2 * node.k + 1);
    return {half.cwiseProduct(middle) - 0.5 * geometry_.spacing_mm, half};
  }
  std::size_t brick_index(const VoxelIndex& b) const { return row_major(bricks_.dims(), b.i, b.j, b.k); }

  // Byte j + 8 k, bit i is set if the node is on the surface.
  using SurfaceMask = std::array<std::uint8_t, kBrickNodes * kBrickNodes>;

  std::uint8_t bone_byte(int byte, int j, int k) const;
  void clear_milled_nodes(const VoxelBox& nodes);
  VoxelBox nodes_touched_by(const VoxelBox& voxels) const;
  SurfaceMask mask_of(const VoxelIndex& brick) const;
  void refresh_brick(const VoxelIndex& brick);

  const Volume* volume_ = nullptr;
  int stride_ = 1;
  GridGeometry geometry_;
  float point_area_mm2_ = 0;
  Vec3 brick_side_mm_ = Vec3::Zero();
  // Largest float that is not bone.
  float bone_above_ = 0;
  BoneBits bone_;
  VoxelBox bricks_;
  // Level of the root, which covers all bricks.
  int root_level_ = 0;
  BrickPoints points_;
  std::vector<SurfaceMask> masks_;
  // Buffer for the points of a brick being rebuilt.
  PointRows found_{kBrickNodes * kBrickNodes * kBrickNodes};
};

template <typename IsApart, typename Visit>
void VoxelShell::visit_node(int level, const VoxelIndex& node, const IsApart& is_apart,
                            const Visit& visit) const {
  if (level == 0 && points_.brick(brick_index(node)).count == 0) return;
  if (is_apart(node_box(level, node))) return;
  if (level == 0) {
    visit(brick_index(node), Vec3(brick_side_mm_.cwiseProduct(Vec3(node.i, node.j, node.k))));
    return;
  }
  const VoxelBox below = bricks_.bricks(1 << (level - 1));
  for_each(VoxelBox::of_brick(node, 2).intersected(below),
           [&](const VoxelIndex& child) { visit_node(level - 1, child, is_apart, visit); });
}

}  // namespace osteomill::point_shell
