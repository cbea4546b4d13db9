#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "osteomill/live/bone_follower.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/volume.h"

#include "cut_history.h"
#include "density_handover.h"

namespace osteomill {

/// The copy of a bone that is milled, what was milled of it, and the exchange by which the copy, changed,
/// becomes the bone. For one thread at a time; none of it is for the haptic one.
class BoneCopy {
 public:
  using NextBone = BoneFollower::NextBone;
  /// `changed` is called with voxels of the copy whose densities have just changed.
  BoneCopy(std::shared_ptr<Volume> bone, std::size_t undo_bytes,
           std::function<void(const VoxelBox&)> changed);

  const Volume& volume() const { return *copy_; }
  const CutHistory& history() const { return history_; }
  /// The bone that is milled: the haptic thread alone reads and writes its densities.
  const std::shared_ptr<Volume>& bone() const { return bone_; }

  /// Puts blocks that were milled at another time into bone and copy, as one cut. Before the first tick.
  void load_milled(const std::vector<DensityBlock>& milled);
  /// Puts what has arrived into the copy, at most as many blocks as can be on their way. Returns the voxels
  /// that it changed.
  VoxelBox drain_queue(DensityHandover& handover);
  void begin_cut(double removed_mm3) { history_.begin_cut(removed_mm3); }

  /// Sets the copy's isovalue, not the bone's.
  void set_isovalue(double isovalue);
  /// Makes the copy the bone that is to be next; `exchange` or `discard_next` ends that. Each is as the
  /// function of the same name of BoneFollower (`exchange` as its `swap`); the last one lowers what milling
  /// had emptied once the copy has its isovalue, at which `densities` were estimated.
  NextBone without_last_cut();
  NextBone without_all_cuts();
  NextBone with_emptied(double surroundings, double removed_mm3, const BoneDensities& densities);
  void exchange();
  void discard_next();

 private:
  enum class UndoScope { nothing, last_cut, all };

  bool put(DensityBlock& block);
  void put_differing();
  NextBone without(const CutHistory::PriorState& cuts, UndoScope undo_scope);

  std::shared_ptr<Volume> bone_;
  std::shared_ptr<Volume> copy_;
  std::function<void(const VoxelBox&)> changed_;
  CutHistory history_;
  // While the copy is to become the bone: how the two differ, and what of the history is then over.
  std::vector<DensityBlock> differing_;
  UndoScope undo_scope_ = UndoScope::nothing;
  // The highest density that a voxel milled empty may have kept, at this isovalue or one before.
  float emptied_ = std::numeric_limits<float>::lowest();
};

}  // namespace osteomill
