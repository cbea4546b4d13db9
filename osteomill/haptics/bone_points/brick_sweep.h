#pragma once

#include "osteomill/volume/grid_geometry.h"

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

}  // namespace osteomill
