#pragma once

#include "osteomill/haptics/bone_points/brick_points.h"
#include "osteomill/haptics/point_shell/bone_bits.h"
#include "osteomill/haptics/point_shell/point_shell_settings.h"
#include "osteomill/volume/volume.h"

namespace osteomill::point_shell {

/// The grid on which the shell finds the bone's surface, and how its nodes make up the cells that have one
/// point each. Nodes are voxels, or (a coarse shell that samples anew) every `stride` voxels; a cell is
/// `group` nodes wide; one of the two is the shell's scale and the other 1. Safe in the haptic tick.
class ShellLattice {
 public:
  ShellLattice() = default;
  ShellLattice(const Volume& volume, const ShellRules& rules);

  const ShellRules& rules() const { return rules_; }
  const std::array<int, 3>& node_dims() const { return geometry_.dims; }
  std::array<int, 3> cell_dims() const;
  int group() const { return group_; }
  /// Where the nodes lie in W.
  const GridGeometry& geometry() const { return geometry_; }
  /// h^2 of a cell of size h (the cube root of its volume).
  double cell_area_mm2() const { return cell_area_mm2_; }

  /// Trilinear density at a node, the outside density beyond the border.
  double density(const VoxelIndex& node) const;
  /// Bit n: whether node 8 * `byte` + n of row j of slice k is bone; the row must be in the lattice.
  std::uint8_t bone_byte(int byte, int j, int k) const;
  bool is_bone(const VoxelIndex& node) const { return density(node) > volume_->isovalue(); }
  /// Asks for rows of nodes ahead of reading them; the box must be in the lattice.
  void prefetch_rows(const VoxelBox& nodes) const;
  /// Whether brick bi, bj, bk of 8 x 8 x 8 cells and all that borders on it is bone, so that it can hold no
  /// surface: may say no where it is so.
  bool is_deep_in_bone(int bi, int bj, int bk) const;
  /// The nodes whose density depends on voxels in `voxels`, within the lattice.
  VoxelBox nodes_touched_by(const VoxelBox& voxels) const;
  /// How far, in nodes, a change of density reaches into points.
  int reach_nodes() const { return rules_.surface_shell ? 2 : 1; }

  /// The point of a cell that has surface nodes, in the frame whose origin is the node `frame_origin` and
  /// whose axes are the grid's.
  ShellPoint point_of_cell(const BoneBits& bone, const VoxelIndex& cell,
                           const VoxelIndex& frame_origin) const;

 private:
  struct WeightedSum {
    Vec3 position_mm = Vec3::Zero();
    Vec3 normal = Vec3::Zero();
    double weight = 0;
  };
  struct Face {
    int axis;
    int side;
    double fraction = 0;
    double weight = 1;
    Vec3 normal_G = Vec3::Zero();
  };
  void add_node(const BoneBits& bone, const VoxelIndex& node, const VoxelIndex& frame_origin,
                WeightedSum& sum) const;
  void add_inner_voxel(const VoxelIndex& voxel, const VoxelIndex& frame_origin, WeightedSum& sum) const;
  void add_face(const Face& face, const VoxelIndex& node, const VoxelIndex& frame_origin,
                WeightedSum& sum) const;
  bool is_inner_voxel(const VoxelIndex& node) const;
  double crossing_fraction(double inside, const VoxelIndex& outer_node) const;
  void weigh_by_area(Face& face, const Vec3& gradient_G) const;
  Vec3 gradient_on_edge(const VoxelIndex& node, int axis, double offset) const;

  const Volume* volume_ = nullptr;
  ShellRules rules_;
  int stride_ = 1;
  int group_ = 1;
  GridGeometry geometry_;
  double cell_area_mm2_ = 0;
  Vec3 face_mm2_ = Vec3::Zero();
  // One half over the spacing, for central differences.
  Vec3 half_per_mm_ = Vec3::Zero();
  // The largest float that is not bone.
  float bone_above_ = 0;
};

}  // namespace osteomill::point_shell
