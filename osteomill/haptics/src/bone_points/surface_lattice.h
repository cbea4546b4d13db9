#pragma once

#include <array>
#include <cstdint>

#include "osteomill/volume/volume.h"

#include "bone_points/brick_kernel.h"
#include "bone_points/brick_points.h"

namespace osteomill {

/// Finds where the isosurface crosses the edges of a lattice, as area-weighted points, brick by brick.
/// Lattice nodes are the voxel centres; along an axis on which these are farther apart than the spacing,
/// nodes subdivide the distance evenly. Every crossing represents A_a |n_a| of surface (A_a: face of a cell
/// across edges along a, n: unit surface normal): three regular lattices, whose sum is a quadrature of the
/// surface for any slope. A point is the weighted mean of the crossings in a cell. A cell is one node or, in
/// a fine scan, 2^n nodes a side, of which only lines at most half the spacing apart are sampled. The volume
/// must outlive this object. Safe in the haptic tick.
class SurfaceLattice {
 public:
  static constexpr int kMaxBrickNodes = static_cast<int>(CrossingRow::kMaxNodes);
  static constexpr int kMaxBlockNodes = kMaxBrickNodes + 3;
  static constexpr std::size_t kMaxPointsOfBrick = 8 * 8 * 8;

  SurfaceLattice() = default;
  SurfaceLattice(const Volume& volume, double spacing_mm);

  const std::array<int, 3>& brick_dims() const { return brick_dims_; }
  /// Brick b begins at the edges whose lower node is `brick_nodes() * b - 1`, so that crossings between the
  /// scan's border and the empty space outside count.
  int brick_nodes() const { return brick_nodes_; }
  /// Returns the number of densities from which a brick's points are computed.
  int densities_of_brick() const { return (brick_nodes_ + 3) * (brick_nodes_ + 3) * (brick_nodes_ + 3); }
  /// Returns the node spacing along each axis.
  const Vec3& step_mm() const { return step_mm_; }
  /// Returns the origin of a brick's frame (the grid's axes) in the grid's frame (origin at voxel 0, 0, 0).
  Vec3 brick_origin_G(const VoxelIndex& brick) const {
    return brick_nodes_ * step_mm_.cwiseProduct(Vec3(brick.i, brick.j, brick.k));
  }
  const Vec3& origin_W() const { return volume_->geometry().origin_mm; }
  const Mat3& direction() const { return volume_->geometry().direction; }

  /// Centre, in the grid's frame, and radius of the bounding sphere of an octree node over the bricks:
  /// 2^level bricks a side, starting at brick 2^level * `node`. half_bricks_to_middle is the centre's offset
  /// from before_first_G in half bricks.
  Vec3 middle_G(int level, const VoxelIndex& node) const {
    return before_first_G() + half_brick_mm().cwiseProduct(half_bricks_to_middle(level, node));
  }
  double radius_mm(int level) const { return brick_radius_mm_ * static_cast<double>(1 << level); }
  Vec3 half_brick_mm() const { return 0.5 * brick_nodes_ * step_mm_; }
  Vec3 before_first_G() const { return -step_mm_; }
  static Vec3 half_bricks_to_middle(int level, const VoxelIndex& node) {
    return static_cast<double>(1 << level) * Vec3(2 * node.i + 1, 2 * node.j + 1, 2 * node.k + 1);
  }

  /// Occupancy of a node. Milling only removes bone: `no_bone` never changes, and `all_bone` may become
  /// `surface`.
  enum class Occupancy { no_bone, all_bone, surface };
  /// Returns the occupancy of a node; conservative: may return `surface` if there is none.
  Occupancy occupancy_of(int level, const VoxelIndex& node) const;
  /// Returns a counter that changes whenever a density falls on which the brick's points depend.
  std::uint32_t changes_of(const VoxelIndex& brick) const;
  /// Returns the bricks whose points may depend on densities in `voxels`.
  VoxelBox bricks_touched_by(const VoxelBox& voxels) const;

  /// Points in the brick's frame: at the lattice's spacing, and at twice that in flat regions
  /// (`merge_flat_cells`).
  struct BrickSurface {
    PointRows fine{kMaxPointsOfBrick};
    PointRows coarse{kMaxPointsOfBrick};
    std::array<std::uint8_t, kMaxPointsOfBrick> coarse_cell;
  };
  /// One bit for each of a brick's rows of nodes along i: bit j of element k.
  using RowBits = std::array<std::uint32_t, kMaxBrickNodes + 1>;
  /// Finds the fine points, and returns the occupancy of the nodes on lines. Skips `empty_rows`, in which no
  /// bone was found before, and adds newly empty rows to it.
  Occupancy find_surface(const VoxelIndex& brick, RowBits& empty_rows, BrickSurface& surface) const;
  /// Computes the coarse points from the fine ones: one for all those in a cell twice as wide if they lie in
  /// a plane; along edges all are kept.
  static void merge_flat_cells(BrickSurface& surface);

 private:
  static constexpr std::size_t kRow = kMaxBlockNodes;
  static constexpr std::size_t kSlice = kRow * kRow;
  // Densities at the nodes of a brick and one more layer all round (two on the upper sides), with padding for
  // the kernel to read beyond a row's end.
  using Block = std::array<float, kSlice * kRow + CrossingRow::kNodes>;
  // Bit n of a row is set if node n is bone.
  using Rows = std::array<std::uint32_t, (kMaxBrickNodes + 1) * (kMaxBrickNodes + 1)>;
  static std::size_t row_index(int j, int k) {
    return static_cast<std::size_t>(j + k * (kMaxBrickNodes + 1));
  }
  VoxelBox voxels_of(int level, const VoxelIndex& node, int more_nodes) const;
  // Strided view of the densities at the nodes of a brick and around them.
  struct Nodes {
    const float* first;
    std::array<std::ptrdiff_t, 3> next;
    const float* at(int i, int j, int k) const { return first + i * next[0] + j * next[1] + k * next[2]; }
  };
  Nodes nodes_of(const VoxelIndex& brick, Block& block) const;
  void copy_voxels(const VoxelIndex& first, Block& block) const;
  void interpolate_voxels(const VoxelIndex& first, Block& block) const;
  float density(const VoxelIndex& voxel) const;
  RowBits find_solid_rows(const VoxelIndex& brick) const;
  Occupancy find_bone(const Nodes& nodes, const RowBits& solid_rows, RowBits& empty_rows, Rows& rows) const;
  bool is_on_line(int node) const { return (line_nodes_ >> node & 1) != 0; }
  // Finds the edges along lines, from a row's nodes, that the surface crosses. Returns false if there are
  // none.
  bool find_crossed(const Rows& rows, int j, int k, std::uint32_t (&crossed)[3]) const {
    const std::uint32_t lower = (1u << brick_nodes_) - 1;
    const std::uint32_t on_j = is_on_line(j) ? lower : 0, on_k = is_on_line(k) ? lower : 0;
    const std::uint32_t here = rows[row_index(j, k)];
    crossed[0] = (here ^ (here >> 1)) & on_j & on_k;
    crossed[1] = (here ^ rows[row_index(j + 1, k)]) & line_nodes_ & on_k;
    crossed[2] = (here ^ rows[row_index(j, k + 1)]) & line_nodes_ & on_j;
    return (crossed[0] | crossed[1] | crossed[2]) != 0;
  }
  std::uint32_t cells_of(std::uint32_t nodes) const;
  void add_cell_means(const Nodes& nodes, const Rows& rows, BrickSurface& surface) const;

  const Volume* volume_ = nullptr;
  std::array<int, 3> steps_per_voxel_{1, 1, 1};
  // Nodes per cell, and spacing of the sampled lines in nodes, along each axis.
  static constexpr int kMaxGroup = 8;
  int group_ = 1;
  int line_step_ = 1;
  // Bit i is set if lines across i pass through node i.
  std::uint32_t line_nodes_ = ~0u;
  int brick_nodes_ = 8;
  std::array<int, 3> brick_dims_{1, 1, 1};
  Vec3 step_mm_ = Vec3::Ones();
  double brick_radius_mm_ = 0;
  // Isovalue and steps; the memory strides are set for each brick.
  CrossingLattice crossings_{};
  // Density assumed outside the grid; always below the isovalue, even if the lowest density in it is bone.
  float outside_ = 0;
};

}  // namespace osteomill
