#pragma once

#include <cstddef>
#include <cstdint>

#include "osteomill/base/pose.h"
#include "osteomill/haptics/milling_tool.h"

#include "bone_points/brick_store.h"
#include "bone_points/brick_tree.h"
#include "bone_points/surface_lattice.h"
#include "bone_points/update_queue.h"

namespace osteomill {

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
  const BrickPoints& fine() const { return store_.fine(); }
  const BrickPoints& coarse() const { return store_.coarse(); }

  /// Goes down the octree into the nodes that `meets` lets through (BrickTree::visit), makes each missing
  /// brick that it reaches, as far as there is room and this tick may make more, and calls `use(brick, slot)`
  /// for each brick with points, in a fixed order. The brick's points are those of `slot` in `fine` and
  /// `coarse`. Returns whether no brick is missing.
  template <typename Meets, typename Use>
  bool make_and_visit(const Meets& meets, const Use& use) {
    bool all = true;
    tree_.visit(meets, [&](int level, const VoxelIndex& node, BrickTree::Place place) {
      look(level, node, place);
      if (level == 0 && tree_.held(place) == BrickTree::kUnseen && queue_.may_make() && store_.has_room())
        queue_.count_made(make_brick(node, place));
      const std::uint32_t held = tree_.held(place);
      if (held == BrickTree::kUnseen) all = false;
      if (level == 0 && BrickTree::is_index(held)) use(node, held);
    });
    return all;
  }
  /// Looks at unseen nodes that `make_and_visit` would reach, as far as this tick may, until it has found
  /// where there may be points. Returns whether it has.
  template <typename Meets>
  bool look_for_points(const Meets& meets) {
    bool found = false;
    const auto if_not_yet = [&](int level, const VoxelIndex& node) {
      return found ? BrickTree::EightBits{0} : meets(level, node);
    };
    tree_.visit(if_not_yet, [&](int level, const VoxelIndex& node, BrickTree::Place place) {
      if (found) return;
      look(level, node, place);
      const std::uint32_t held = tree_.held(place);
      found = held == BrickTree::kUnseen || (level == 0 && BrickTree::is_index(held));
    });
    return found;
  }

  /// About how many points of bricks that do not bear the tool are brought up to date a tick.
  static constexpr int kOthersPerTick = 100;
  /// Says that densities fell in `voxels`, and brings points up to date. Bricks into which the surface has
  /// newly come are made at once, or the next time the tool meets them. Bricks that bear the tool take turns
  /// (UpdateQueue). Of all other bricks about `others` points are done a tick; new bricks and passing over
  /// unchanged ones count as points too.
  void refresh(const VoxelBox& voxels, int others = kOthersPerTick) noexcept;
  /// Lists the bricks that bear the tool, by their slots; the user of the points keeps the list.
  void clear_bearing() { queue_.clear_bearing(); }
  void add_bearing(std::uint32_t slot) { queue_.add_bearing(slot); }
  bool is_up_to_date() const { return queue_.is_empty(); }
  /// Returns how many bricks still have to be looked at, those that bear the tool among them.
  std::size_t owed() const noexcept { return queue_.size(); }
  /// Makes room if little is left, by forgetting what is not near the tool.
  void make_room(const MillingTool& tool, const Pose& X_WT) noexcept;
  /// Begins a tick: makes room, and brings bricks that still wait up to date if no densities fell since the
  /// tick before. From the first tick on a tick makes no more bricks than it has time for.
  void begin_tick(const MillingTool& tool, const Pose& X_WT) noexcept {
    if (queue_.begin_tick()) refresh({});
    make_room(tool, X_WT);
  }
  /// Points that found no room as bricks that had some grew.
  std::uint64_t dropped() const { return fine().dropped() + coarse().dropped(); }

 private:
  void look(int level, const VoxelIndex& node, BrickTree::Place place);
  int cost_of(std::uint32_t slot) const;
  int make_brick(const VoxelIndex& brick, BrickTree::Place place);
  int make_new(const VoxelIndex& brick);
  int remake(const VoxelIndex& brick);

  SurfaceLattice lattice_;
  BrickTree tree_;
  BrickStore store_;
  UpdateQueue queue_;
};

}  // namespace osteomill
