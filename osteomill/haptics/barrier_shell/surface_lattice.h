#pragma once

#include <array>
#include <cstdint>

#include "osteomill/haptics/bone_points/brick_points.h"
#include "osteomill/volume/volume.h"

namespace osteomill::barrier_shell {

/// Where the isosurface crosses the edges of a lattice, as area-weighted points, brick by brick. Lattice
/// nodes are the voxels' centres or, in a coarse scan, a whole number of steps between two of them, so that
/// they lie at most the wanted spacing apart. Every crossing is a point that stands for A_a |n_a| of surface
/// (A_a the face of a cell across edges along a, n the surface's unit normal): three regular lattices, whose
/// sum is a quadrature of the surface whatever its slope. In a fine scan a point is the weighted mean of the
/// crossings in a cell of 2^n nodes. The volume outlives it. Safe in the haptic tick.
class SurfaceLattice {
 public:
  static constexpr int kMaxBrickNodes = 16;
  static constexpr int kMaxBlockNodes = kMaxBrickNodes + 3;
  static constexpr std::size_t kMaxPointsOfBrick = 3 * 8 * 8 * 8;

  SurfaceLattice() = default;
  SurfaceLattice(const Volume& volume, double spacing_mm);

  const std::array<int, 3>& brick_dims() const { return brick_dims_; }
  /// Brick b begins at the edges whose lower node is `brick_nodes() * b - 1`: crossings between the scan's
  /// border and the nothing beyond it count.
  int brick_nodes() const { return brick_nodes_; }
  /// The densities that a brick's points are made from.
  int densities_of_brick() const { return (brick_nodes_ + 3) * (brick_nodes_ + 3) * (brick_nodes_ + 3); }
  /// Of neighbouring nodes.
  const Vec3& step_mm() const { return step_mm_; }
  /// Origin of a brick's frame (the grid's axes) in the grid's frame (origin at voxel 0, 0, 0).
  Vec3 brick_origin_G(const VoxelIndex& brick) const {
    return brick_nodes_ * step_mm_.cwiseProduct(Vec3(brick.i, brick.j, brick.k));
  }
  const Vec3& origin_W() const { return volume_->geometry().origin_mm; }
  const Mat3& direction() const { return volume_->geometry().direction; }

  /// May say yes where there is none.
  bool may_hold_surface(const VoxelIndex& brick) const;
  /// The bricks whose points may change with densities in `voxels`.
  VoxelBox bricks_touched_by(const VoxelBox& voxels) const;

  /// Points in the brick's frame, at the lattice's spacing and, where asked for, at twice that in flat
  /// places.
  struct BrickSurface {
    std::array<ShellPoint, kMaxPointsOfBrick> fine;
    std::array<ShellPoint, kMaxPointsOfBrick> coarse;
    std::array<std::uint8_t, kMaxPointsOfBrick> coarse_cell;
    std::size_t fine_count = 0;
    std::size_t coarse_count = 0;
    /// Of the densities that these are the points of.
    std::uint64_t fingerprint = 0;
  };
  static constexpr int kUnchanged = -1;
  /// How many edges were crossed; `kUnchanged`, and no points, where `surface.fingerprint` is that of the
  /// densities as they still are.
  int find_surface(const VoxelIndex& brick, BrickSurface& surface) const;

 private:
  static constexpr std::size_t kRow = kMaxBlockNodes;
  static constexpr std::size_t kSlice = kRow * kRow;
  // Densities at the nodes of a brick and one more all round (two at the upper sides).
  using Block = std::array<float, kSlice * kRow + 1>;
  static std::size_t block_index(int i, int j, int k) {
    return static_cast<std::size_t>(i + 1) + static_cast<std::size_t>(j + 1) * kRow +
           static_cast<std::size_t>(k + 1) * kSlice;
  }
  // Bit n of a row: whether its node n is bone.
  using Rows = std::array<std::uint32_t, (kMaxBrickNodes + 1) * (kMaxBrickNodes + 1)>;
  static std::size_t row_index(int j, int k) {
    return static_cast<std::size_t>(j + k * (kMaxBrickNodes + 1));
  }
  VoxelBox voxels_of(const VoxelIndex& brick) const;
  void read_block(const VoxelIndex& brick, Block& block) const;
  void read_voxels(const VoxelIndex& first, Block& block) const;
  void interpolate_voxels(const VoxelIndex& first, Block& block) const;
  float density(const VoxelIndex& voxel) const;
  std::uint64_t fingerprint_of(const Block& block) const;
  bool find_bone(const Block& block, Rows& rows) const;
  template <typename F>
  int for_each_crossing(const Block& block, const Rows& rows, F&& f) const;
  int list_crossings(const Block& block, const Rows& rows, BrickSurface& surface) const;
  int mean_crossings(const Block& block, const Rows& rows, BrickSurface& surface) const;
  static void merge_flat_cells(BrickSurface& surface);
  ShellPoint crossing(const float* here, const VoxelIndex& node, int axis) const;

  const Volume* volume_ = nullptr;
  int steps_per_voxel_ = 1;
  int group_ = 1;
  int brick_nodes_ = 8;
  std::array<int, 3> brick_dims_{1, 1, 1};
  Vec3 step_mm_ = Vec3::Ones();
  Eigen::Vector3f step_ = Eigen::Vector3f::Ones();
  Eigen::Vector3f per_step_ = Eigen::Vector3f::Ones();
  Eigen::Vector3f face_mm2_ = Eigen::Vector3f::Zero();
  float isovalue_ = 0;
  // Nothing beyond the border, also where the least density is bone's.
  float outside_ = 0;
};

}  // namespace osteomill::barrier_shell
