#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "osteomill/base/pose.h"
#include "osteomill/haptics/milling_tool.h"

#include "bone_points/surface_lattice.h"

namespace osteomill {

/// Which bricks still have to be looked at after voxels changed. Changed voxels wait in one box; a walk then
/// visits every brick of a box, one after the other, over as many ticks as that takes. Safe in the haptic
/// tick.
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
  const VoxelBox& waiting() const { return waiting_; }

  /// Begins at the first brick of the box.
  void start(const VoxelBox& bricks) {
    bricks_ = bricks;
    brick_ = bricks.first;
  }
  bool is_walking() const { return !bricks_.empty(); }
  const VoxelIndex& brick() const { return brick_; }
  /// How many bricks the walk has before it.
  std::size_t bricks_left() const {
    if (!is_walking()) return 0;
    const std::array<int, 3> dims = bricks_.dims();
    const std::size_t row = static_cast<std::size_t>(dims[0]),
                      slice = row * static_cast<std::size_t>(dims[1]);
    const VoxelIndex& first = bricks_.first;
    return cell_count(dims) - static_cast<std::size_t>(brick_.i - first.i) -
           row * static_cast<std::size_t>(brick_.j - first.j) -
           slice * static_cast<std::size_t>(brick_.k - first.k);
  }

  /// On to the next brick, or the end.
  void advance() {
    if (++brick_.i <= bricks_.last.i) return;
    brick_.i = bricks_.first.i;
    if (++brick_.j <= bricks_.last.j) return;
    brick_.j = bricks_.first.j;
    if (++brick_.k <= bricks_.last.k) return;
    bricks_ = {};
  }

 private:
  VoxelBox waiting_;
  VoxelBox bricks_;
  VoxelIndex brick_;
};

/// The bone's surface as points in bricks under an octree. Bricks are made when the tool comes near and
/// forgotten when room runs out, and so are the octree's nodes: neither time nor memory grows with the scan.
/// Milling takes densities away only, so a brick that has not been brought up to date shows more bone than
/// there is. Building allocates; all else is safe in the haptic tick.
class BoneBricks {
 public:
  /// For a burr of a millimetre, points nearer to one another say nothing more.
  static constexpr double kSpacing_mm = 0.13;

  BoneBricks() = default;
  /// `volume` outlives it. Fine points are at most `spacing_mm` apart, coarse ones twice that where the bone
  /// is flat.
  BoneBricks(const Volume& volume, double spacing_mm);

  const SurfaceLattice& lattice() const { return lattice_; }
  const BrickPoints& fine() const { return fine_; }
  const BrickPoints& coarse() const { return coarse_; }

  /// Goes down the octree, leaving out every node for whose bounding sphere (in the grid's frame)
  /// `meets(middle_G, radius_mm)` is false, and calls `use(brick, slot)` for each brick with points that it
  /// reaches, in a fixed order. The brick's points are those of `slot` in `fine` and `coarse`. Bricks that do
  /// not exist yet are made, as far as there is room and this tick may make more. Returns whether no brick
  /// is missing.
  template <typename Meets, typename Use>
  bool visit(const Meets& meets, const Use& use) {
    bool all = true;
    walk(levels_, {}, kRoot, meets, [&](int level, const VoxelIndex& brick, std::uint32_t& place) {
      if (level == 0 && place == kUnseen && may_make_ > 0 && has_room()) may_make_ -= make(brick, place);
      if (place == kUnseen) all = false;
      if (level == 0 && is_index(place)) use(brick, place);
    });
    return all;
  }
  /// Whether there may be points where `meets` says yes. Makes no bricks.
  template <typename Meets>
  bool may_hold_points(const Meets& meets) {
    bool may = false;
    const auto if_not_yet = [&](const Vec3& middle_G, double radius_mm) {
      return !may && meets(middle_G, radius_mm);
    };
    walk(levels_, {}, kRoot, if_not_yet, [&](int, const VoxelIndex&, std::uint32_t&) { may = true; });
    return may;
  }

  /// About how many points are brought up to date a tick: of bricks that bear the tool, and of all others.
  /// (Tried: bringing a bearing brick up to date only once its surface has sunk by 2 um, judged by bone lost
  /// over area. It took half the time but doubled the steps of torque, 0.28 N mm for 0.14; tooth, 3 N.)
  static constexpr int kBearingPerTick = 1500;
  static constexpr int kOthersPerTick = 100;
  /// About how many points are made a tick of bricks that the tool meets for the first time.
  static constexpr int kMadePerTick = 2500;
  /// Says that densities fell in `voxels`, and brings points up to date. Bricks into which the surface has
  /// newly come are made at once, or the next time the tool meets them. Bricks that bear the tool take turns
  /// over so many ticks that each tick does about kBearingPerTick points. Of all other bricks about `others`
  /// points are done a tick; new bricks and passing over unchanged ones count as points too.
  void refresh(const VoxelBox& voxels, int others = kOthersPerTick) noexcept;
  /// The slots of the bricks that bear the tool. Whoever uses the points keeps this list. The tool rests on
  /// these bricks: if they waited with the others, it would stand still and drop once the last had its turn.
  std::vector<std::uint32_t>& bearing() { return bearing_; }
  bool is_up_to_date() const { return sweep_.is_idle(); }
  /// How many bricks still have to be looked at, those that bear the tool among them.
  std::size_t owed() const noexcept {
    const VoxelBox waiting = lattice_.bricks_touched_by(sweep_.waiting());
    return bearing_owed_ + sweep_.bricks_left() + (waiting.empty() ? 0 : cell_count(waiting.dims()));
  }
  /// Makes room if little is left, by forgetting what is not near the tool.
  void make_room(const MillingTool& tool, const Pose& X_WT) noexcept;
  /// What a tick begins with: room is made, and bricks that still wait are brought up to date where no
  /// densities fell since the tick before. From the first tick on a tick makes no more bricks than it has
  /// time for (kMadePerTick).
  void begin_tick(const MillingTool& tool, const Pose& X_WT) noexcept {
    may_make_ = kMadePerTick;
    if (!refreshed_ && !is_up_to_date()) refresh({});
    refreshed_ = false;
    make_room(tool, X_WT);
  }
  /// Points that found no room as bricks that had some grew.
  std::uint64_t dropped() const { return fine_.dropped() + coarse_.dropped(); }

 private:
  // What a place of the octree holds: the index of a node or, of a brick, of its slot; or what else is known.
  static constexpr std::uint32_t kUnseen = 0xffffffffu;
  static constexpr std::uint32_t kNoBone = 0xfffffffeu;
  static constexpr std::uint32_t kBoneAlone = 0xfffffffdu;
  static bool is_index(std::uint32_t place) { return place < kBoneAlone; }
  static constexpr std::uint32_t kRoot = 0;
  struct Node {
    std::array<std::uint32_t, 8> places;
    // Null of the root, and where the node is free.
    std::uint32_t* place = nullptr;
  };

  template <typename Meets, typename Leaf>
  void walk(int level, const VoxelIndex& node, std::uint32_t index, const Meets& meets, const Leaf& leaf) {
    --level;
    for (int n = 0; n < 8; ++n) {
      const VoxelIndex below{2 * node.i + n % 2, 2 * node.j + n / 2 % 2, 2 * node.k + n / 4};
      std::uint32_t& place = nodes_[index].places[static_cast<std::size_t>(n)];
      if (place == kNoBone || place == kBoneAlone || !meets(middle_G(level, below), radius_mm(level)))
        continue;
      if (place == kUnseen && may_make_ > 0 && !look(level, below, place)) continue;
      if (level == 0 || place == kUnseen) {
        leaf(level, below, place);
      } else {
        walk(level, below, place, meets, leaf);
      }
    }
  }
  Vec3 middle_G(int level, const VoxelIndex& node) const;
  double radius_mm(int level) const { return brick_radius_mm_ * static_cast<double>(1 << level); }
  bool look(int level, const VoxelIndex& node, std::uint32_t& place);
  struct Found {
    int level;
    std::uint32_t* place;
  };
  Found find(const VoxelIndex& brick);
  int make(const VoxelIndex& brick, std::uint32_t& place);
  int make_new(const VoxelIndex& brick);
  int remake(const VoxelIndex& brick);
  void remake_bearing();
  bool start_sweep();
  bool is_short_of_room() const;
  bool has_room() const;
  bool is_near(const MillingTool& tool, const Pose& X_TW, const VoxelIndex& brick) const;
  void forget(std::uint32_t slot);
  void forget_node(Node& node);

  SurfaceLattice lattice_;
  double brick_radius_mm_ = 0;
  // Of the octree, bricks not counted.
  int levels_ = 1;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> free_nodes_;
  BrickPoints fine_;
  BrickPoints coarse_;
  std::vector<std::uint32_t> free_slots_;
  // Which brick a slot is of, of which densities its points are, and where those had no bone.
  std::vector<VoxelIndex> brick_of_slot_;
  std::vector<std::uint32_t> changes_;
  std::vector<SurfaceLattice::RowBits> without_bone_;
  std::size_t next_to_forget_ = 0;
  std::size_t next_node_to_forget_ = 0;
  BrickSweep sweep_;
  std::vector<std::uint32_t> bearing_;
  std::size_t bearing_owed_ = 0;
  // In points, what is left of kMadePerTick.
  int may_make_ = std::numeric_limits<int>::max();
  std::uint32_t refreshes_ = 0;
  bool refreshed_ = false;
  SurfaceLattice::BrickSurface found_;
};

}  // namespace osteomill
