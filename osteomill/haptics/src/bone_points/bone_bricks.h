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

/// The bone's surface as points in bricks under an octree. Bricks and octree nodes are built when the tool
/// comes near and evicted when memory runs short, so neither time nor memory grows with the scan. Milling
/// only lowers densities, so a brick that is not up to date shows more bone than there is. Building
/// allocates; all else is safe in the haptic tick.
class BoneBricks {
 public:
  /// Point spacing, mm. For a burr of a millimetre, denser points add no information.
  static constexpr double kSpacing_mm = 0.13;

  BoneBricks() = default;
  /// `volume` must outlive this object. Fine points are at most `spacing_mm` apart, coarse ones twice that on
  /// flat bone. `tick_s` is the nominal length of a tick.
  BoneBricks(const Volume& volume, double spacing_mm, double tick_s = 1e-3);

  const SurfaceLattice& lattice() const { return lattice_; }
  const BrickPoints& fine() const { return store_.fine(); }
  const BrickPoints& coarse() const { return store_.coarse(); }

  /// Descends the octree into the nodes selected by `overlap` (BrickTree::visit), builds each missing brick
  /// that it reaches, within memory and this tick's budget, and calls `use(brick, slot)` for each brick with
  /// points, in a fixed order. The brick's points are those of `slot` in `fine` and `coarse`. Returns false
  /// if a brick is still missing.
  template <typename Overlap, typename Use>
  bool build_and_visit(const Overlap& overlap, const Use& use) {
    bool all = true;
    tree_.visit(overlap, [&](int level, const VoxelIndex& node, BrickTree::EntryIndex entry) {
      classify(level, node, entry);
      if (level == 0 && tree_.content(entry) == BrickTree::kUnknown && queue_.has_build_budget() &&
          store_.has_free_space())
        queue_.spend_build_budget(build_brick(node, entry));
      const std::uint32_t content = tree_.content(entry);
      if (content == BrickTree::kUnknown) all = false;
      if (level == 0 && BrickTree::is_index(content)) use(node, content);
    });
    return all;
  }
  /// Classifies unknown nodes that `build_and_visit` would reach, within this tick's budget, until one may
  /// contain points. Returns whether it found one.
  template <typename Overlap>
  bool search_for_points(const Overlap& overlap) {
    bool found = false;
    const auto if_not_yet = [&](int level, const VoxelIndex& node) {
      return found ? BrickTree::EightBits{0} : overlap(level, node);
    };
    tree_.visit(if_not_yet, [&](int level, const VoxelIndex& node, BrickTree::EntryIndex entry) {
      if (found) return;
      classify(level, node, entry);
      const std::uint32_t content = tree_.content(entry);
      found = content == BrickTree::kUnknown || (level == 0 && BrickTree::is_index(content));
    });
    return found;
  }

  /// Approximate number of points updated per tick in bricks that do not support the tool.
  static constexpr int kOtherPointsPerTick = 100;
  /// Updates points after densities fell in `voxels`. Bricks that the surface enters are built at once, or
  /// when the tool next comes near. Bricks that support the tool take turns (UpdateQueue). In all other
  /// bricks about `others` points are updated per tick; building bricks and skipping unchanged ones are
  /// charged as points too.
  void refresh(const VoxelBox& voxels, int others = kOtherPointsPerTick) noexcept;
  /// List the slots of the bricks that support the tool, with their load in any unit. The caller must refresh
  /// the list after every step.
  void clear_supporting() { queue_.clear_supporting(); }
  void add_supporting(std::uint32_t slot, float load) { queue_.add_supporting(slot, load); }
  bool is_up_to_date() const { return queue_.is_empty(); }
  /// Returns the number of bricks that await an update, including supporting ones.
  std::size_t pending_count() const noexcept { return queue_.size(); }
  /// Evicts bricks and nodes far from the tool if memory runs short.
  void evict_far_bricks(const MillingTool& tool, const Pose& X_WT) noexcept;
  /// Begins a tick: evicts bricks if memory runs short, and updates pending bricks if no densities fell since
  /// the last tick. From the first call on, each tick builds bricks only within its budget.
  void begin_tick(const MillingTool& tool, const Pose& X_WT) noexcept {
    if (queue_.begin_tick()) refresh({});
    evict_far_bricks(tool, X_WT);
  }
  /// Returns the number of points dropped because the pool was full when a brick grew.
  std::uint64_t dropped() const { return fine().dropped() + coarse().dropped(); }

 private:
  void classify(int level, const VoxelIndex& node, BrickTree::EntryIndex entry);
  int cost_of(std::uint32_t slot) const;
  int build_brick(const VoxelIndex& brick, BrickTree::EntryIndex entry);
  int build_exposed(const VoxelIndex& brick);
  int rebuild_if_stale(const VoxelIndex& brick);

  SurfaceLattice lattice_;
  BrickTree tree_;
  BrickStore store_;
  UpdateQueue queue_;
};

}  // namespace osteomill
