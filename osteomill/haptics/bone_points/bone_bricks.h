#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "osteomill/geometry/pose.h"
#include "osteomill/haptics/bone_points/count_pyramid.h"
#include "osteomill/haptics/bone_points/surface_lattice.h"
#include "osteomill/numbers/row_major.h"
#include "osteomill/tool/milling_tool.h"

namespace osteomill {

/// The way of changed voxels into bricks of points: what has changed waits, and a walk goes through all
/// bricks near it twice, one brick after the other, so that a tick may do as much of it as it has time for.
/// Whoever owns the points says what a visit does in each pass. Safe in the haptic tick.
class BrickSweep {
 public:
  /// Takes a change in; empty where nothing changed.
  void wait_for(const VoxelBox& voxels) {
    if (voxels.empty()) return;
    waiting_.include(voxels.first);
    waiting_.include(voxels.last);
  }
  /// What has waited since the last call, and now no longer does.
  VoxelBox take_waiting() {
    const VoxelBox taken = waiting_;
    waiting_ = {};
    return taken;
  }
  bool is_idle() const { return !is_walking() && waiting_.empty(); }

  /// Begins at the first brick of the box, in the first pass.
  void start(const VoxelBox& bricks) {
    bricks_ = bricks;
    brick_ = bricks.first;
    first_pass_ = true;
  }
  bool is_walking() const { return !bricks_.empty(); }
  bool is_first_pass() const { return first_pass_; }
  const VoxelIndex& brick() const { return brick_; }

  /// On to the next brick, the next pass, or the end.
  void advance() {
    if (++brick_.i <= bricks_.last.i) return;
    brick_.i = bricks_.first.i;
    if (++brick_.j <= bricks_.last.j) return;
    brick_.j = bricks_.first.j;
    if (++brick_.k <= bricks_.last.k) return;
    if (!first_pass_) bricks_ = {};
    first_pass_ = false;
    brick_ = bricks_.first;
  }

 private:
  VoxelBox waiting_;
  VoxelBox bricks_;
  VoxelIndex brick_;
  bool first_pass_ = false;
};

/// The bone's surface as points in bricks, made when the tool comes near and forgotten when room runs out, so
/// that neither time nor, but for 9 bytes a brick, memory grows with the scan. Milling takes densities away
/// only, so a brick that has not been brought up to date shows more bone than there is. Building allocates;
/// all else is safe in the haptic tick.
class BoneBricks {
 public:
  enum class Points {
    /// All at the lattice's spacing.
    fine,
    /// Others as well, twice as far apart where the bone is flat.
    fine_and_coarse
  };

  /// For a burr of a millimetre, points nearer to one another say nothing more.
  static constexpr double kSpacing_mm = 0.13;

  BoneBricks() = default;
  /// `volume` outlives it. Points at most `spacing_mm` apart.
  BoneBricks(const Volume& volume, double spacing_mm, Points points);

  const SurfaceLattice& lattice() const { return lattice_; }
  const BrickPoints& fine() const { return fine_; }
  const BrickPoints& coarse() const { return coarse_; }
  /// Counts points of the bricks that were made, and one of each other that may have some.
  const CountPyramid& octree() const { return octree_; }
  /// A box that holds all points of a node of the octree, in the grid's frame: its middle, and the radius of
  /// the sphere about it.
  Vec3 node_middle_G(int level, int i, int j, int k) const;
  double node_radius_mm(int level) const { return node_radii_mm_[static_cast<std::size_t>(level)]; }

  static constexpr std::uint32_t kNoPoints = 0xffffffffu;
  /// The slot of the brick in `fine` and `coarse`, which is made if it was not; `kNoPoints` where it has
  /// none, or where there is no room to make it.
  std::uint32_t slot_of(const VoxelIndex& brick);

  /// About how many points are brought up to date a tick.
  static constexpr int kRefreshedPerTick = 700;
  /// Says that densities fell in `voxels`, and brings about `budget` points up to date, and what it takes to
  /// find them.
  void refresh(const VoxelBox& voxels, int budget = kRefreshedPerTick);
  bool is_up_to_date() const { return sweep_.is_idle(); }
  /// Makes room if little is left, by forgetting bricks that are not near the tool.
  void make_room(const MillingTool& tool, const Pose& X_WT);
  /// Points that found no room as bricks that had some grew.
  std::uint64_t dropped() const { return fine_.dropped() + coarse_.dropped(); }

 private:
  static constexpr std::uint32_t kUnmade = 0xfffffffeu;
  // Without points, and without bone: it will have none.
  static constexpr std::uint32_t kEmptied = 0xfffffffdu;

  std::size_t index_of(const VoxelIndex& b) const { return row_major(octree_.dims(0), b.i, b.j, b.k); }
  int make(const VoxelIndex& brick);
  int visit(const VoxelIndex& brick);
  bool start_sweep();
  bool is_short_of_room() const;
  bool has_room() const;
  bool is_near(const MillingTool& tool, const Pose& X_TW, const VoxelIndex& brick) const;
  void forget(std::uint32_t slot);

  SurfaceLattice lattice_;
  Points kinds_ = Points::fine;
  CountPyramid octree_;
  std::vector<double> node_radii_mm_;
  std::vector<std::uint32_t> slots_;
  BrickPoints fine_;
  BrickPoints coarse_;
  std::vector<std::uint32_t> free_slots_;
  // Which brick a slot is of, and of which densities its points are.
  std::vector<VoxelIndex> brick_of_slot_;
  std::vector<std::uint32_t> changes_;
  std::size_t next_to_forget_ = 0;
  BrickSweep sweep_;
  std::unique_ptr<SurfaceLattice::BrickSurface> found_;
};

}  // namespace osteomill
