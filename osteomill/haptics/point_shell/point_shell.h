#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "osteomill/haptics/bone_points/brick_points.h"
#include "osteomill/haptics/bone_points/brick_sweep.h"
#include "osteomill/haptics/bone_points/count_pyramid.h"
#include "osteomill/haptics/point_shell/bone_bits.h"
#include "osteomill/haptics/point_shell/shell_lattice.h"

namespace osteomill::point_shell {

/// The milled object as a point shell ("MPO", Eriksson 2012, 6.1): one point for every cell of the grid that
/// holds surface voxels (bone with one of its 6 neighbours not bone), in bricks of 8 x 8 x 8 cells under an
/// octree. Building allocates; `refresh` does not, and is safe in the haptic tick.
class PointShell {
 public:
  static constexpr int kBrickCells = 8;
  static constexpr std::size_t kMaxPointsOfBrick = 512;

  PointShell() = default;
  /// `volume` outlives the shell.
  PointShell(const Volume& volume, const ShellRules& rules);

  /// Says that densities fell in `voxels`, and brings points up to date as
  /// `ShellRules::refreshed_points_per_tick` has it: once a tick, with an empty box where nothing fell.
  void refresh(const VoxelBox& voxels);
  /// Whether no change waits for a later `refresh`.
  bool is_up_to_date() const { return sweep_.is_idle(); }

  const ShellLattice& lattice() const { return lattice_; }
  const CountPyramid& octree() const { return octree_; }
  const BrickPoints& points() const { return points_; }
  std::size_t brick_index(int bi, int bj, int bk) const {
    const auto& dims = octree_.dims(0);
    return static_cast<std::size_t>(bi) +
           static_cast<std::size_t>(dims[0]) *
               (static_cast<std::size_t>(bj) +
                static_cast<std::size_t>(dims[1]) * static_cast<std::size_t>(bk));
  }
  /// The origin of a brick's frame in the grid's frame G (the grid's axes, mm, origin at lattice node 0,0,0).
  Vec3 brick_origin_G(int bi, int bj, int bk) const { return brick_side_mm_.cwiseProduct(Vec3(bi, bj, bk)); }
  /// An axis-aligned box of G that holds all points below a node of the octree: middle and half widths.
  struct NodeBox {
    Vec3 middle_G;
    Vec3 half_mm;
  };
  NodeBox node_box(int level, int i, int j, int k) const {
    const double bricks = static_cast<double>(1 << level);
    const Vec3 half = 0.5 * bricks * brick_side_mm_;
    return {half.cwiseProduct(Vec3(2 * i + 1, 2 * j + 1, 2 * k + 1)) - 0.5 * lattice_.geometry().spacing_mm,
            half + box_margin_mm_};
  }
  /// Where G lies in W: points `origin + direction * p_G`.
  const Vec3& origin_W() const { return lattice_.geometry().origin_mm; }
  const Mat3& direction() const { return lattice_.geometry().direction; }

  std::uint32_t point_count() const { return octree_.total(); }
  /// Calls `f(point_W, area_mm2)` for every point, brick by brick, in the order of the grid. Not for the
  /// tick.
  template <typename F>
  void for_each_point(F&& f) const;

 private:
  using CellMask = std::array<std::uint8_t, 64>;

  void find_bone();
  void lower_bone(const VoxelBox& nodes);
  VoxelBox cells_of_nodes(const VoxelBox& nodes) const;
  CellMask mask_of(int bi, int bj, int bk, const VoxelBox& cells, CellMask mask) const;
  std::uint8_t mask_byte(int bi, int j, int k) const;
  bool start_sweep();
  int cost_of_next_brick() const;
  int lowering_cost() const;
  int refreshing_cost(int points) const;
  int visit(const VoxelIndex& brick);
  VoxelBox nodes_of_brick(const VoxelIndex& brick) const;
  bool holds_no_bone(const VoxelIndex& brick) const;
  int refresh_brick(int bi, int bj, int bk, const VoxelBox& cells);
  int move_points(int bi, int bj, int bk, const VoxelBox& cells);
  int rebuild_brick(int bi, int bj, int bk, const VoxelBox& cells, const CellMask& mask);
  ShellPoint point_of(const VoxelIndex& cell, int bi, int bj, int bk) const;

  ShellLattice lattice_;
  BoneBits bone_;
  CountPyramid octree_;
  BrickPoints points_;
  std::vector<CellMask> masks_;
  Vec3 brick_side_mm_ = Vec3::Zero();
  Vec3 box_margin_mm_ = Vec3::Zero();
  // Room for one brick's points while it is rebuilt.
  std::vector<ShellPoint> old_points_;
  std::vector<ShellPoint> new_points_;
  // First to find where bone has gone, then, now that each brick's neighbours are known, to bring the points
  // up to date.
  BrickSweep sweep_;
  VoxelBox swept_nodes_;
  VoxelBox swept_cells_;
};

template <typename F>
void PointShell::for_each_point(F&& f) const {
  const auto& dims = octree_.dims(0);
  for (int bk = 0; bk < dims[2]; ++bk) {
    for (int bj = 0; bj < dims[1]; ++bj) {
      for (int bi = 0; bi < dims[0]; ++bi) {
        const BrickPoints::Brick& brick = points_.brick(brick_index(bi, bj, bk));
        std::uint32_t left = brick.count;
        for (std::uint32_t c = brick.first_chunk; c != BrickPoints::kNoChunk; c = points_.next_chunk(c)) {
          for (std::size_t slot = 0; slot < PointChunk::kSlots && left > 0; ++slot, --left) {
            const ShellPoint p = points_.chunk(c).point(slot);
            const Vec3 local(static_cast<double>(p.x_mm), static_cast<double>(p.y_mm),
                             static_cast<double>(p.z_mm));
            f(Vec3(origin_W() + direction() * (brick_origin_G(bi, bj, bk) + local)),
              static_cast<double>(p.area_mm2));
          }
        }
      }
    }
  }
}

}  // namespace osteomill::point_shell
