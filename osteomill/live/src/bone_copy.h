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
  /// Returns as BoneFollower::drops_by_label does.
  std::vector<double> drops_by_label() const;
  /// The bone that is milled: the haptic thread alone reads and writes its densities.
  const std::shared_ptr<Volume>& bone() const { return bone_; }

  /// Puts blocks that were milled at another time into bone and copy, as one cut, of which `piece_drops` is
  /// pieces. Before the first tick.
  void load_milled(const std::vector<DensityBlock>& milled, const std::vector<double>& piece_drops);
  /// Puts what has arrived into the copy, at most as many blocks as can be on their way. Returns the voxels
  /// that it changed.
  VoxelBox drain_queue(DensityHandover& handover);
  void begin_cut(double removed_mm3) { history_.begin_cut(removed_mm3); }

  /// Sets the copy's isovalue, not the bone's.
  void set_isovalue(double isovalue);
  /// Makes the copy the bone that is to be next; `exchange` or `discard_next` ends that. Each is as the
  /// function of the same name of BoneFollower (`exchange` as its `swap`); the last one lowers what milling
  /// had emptied once the copy has its isovalue, at which `densities` were estimated.
  NextBone without_last_cut(double removed_mm3);
  NextBone with_undone_cut(double removed_mm3);
  NextBone without_all_cuts();
  NextBone without_pieces(std::vector<DensityBlock> without, double removed_mm3);
  NextBone with_emptied(double surroundings, double removed_mm3, const BoneDensities& densities);
  void exchange();
  void discard_next();

 private:
  // Names what the exchange means for the history.
  enum class Step { none, undo, redo, reset, pieces };

  bool put(DensityBlock& block);
  void put_differing();
  NextBone with(const CutHistory::SavedState& state, Step step, double removed_mm3);
  void note_step();

  std::shared_ptr<Volume> bone_;
  std::shared_ptr<Volume> copy_;
  std::function<void(const VoxelBox&)> changed_;
  CutHistory history_;
  // While the copy is to become the bone: how the two differ, by what step, and what is removed of the bone.
  std::vector<DensityBlock> differing_;
  Step step_ = Step::none;
  double removed_mm3_ = 0;
  // The highest density that a voxel milled empty may have kept, at this isovalue or one before.
  float emptied_ = std::numeric_limits<float>::lowest();
};

}  // namespace osteomill
