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

/// The copy of a bone that is milled, the milling history, and the exchange by which the modified copy
/// becomes the bone. For one thread at a time, never the haptic one.
class BoneCopy {
 public:
  using NextBone = BoneFollower::NextBone;
  /// Later calls `changed` with the voxels of the copy whose densities have just changed.
  BoneCopy(std::shared_ptr<Volume> bone, std::size_t undo_bytes,
           std::function<void(const VoxelBox&)> changed);

  const Volume& volume() const { return *copy_; }
  const CutHistory& history() const { return history_; }
  /// See BoneFollower::drops_by_label.
  std::vector<double> drops_by_label() const;
  /// Returns the milled bone, whose densities only the haptic thread reads and writes.
  const std::shared_ptr<Volume>& bone() const { return bone_; }

  /// Applies earlier milling to bone and copy, as one cut of which `piece_drops` was removed as pieces. Call
  /// before the first tick.
  void load_milled(const std::vector<DensityBlock>& milled, const std::vector<double>& piece_drops);
  /// Applies queued blocks to the copy, at most as many as the queue holds. Returns the changed voxels.
  VoxelBox drain_queue(DensityHandover& handover);
  void begin_cut(double removed_mm3) { history_.begin_cut(removed_mm3); }

  /// Sets the copy's isovalue, not the bone's.
  void set_isovalue(double isovalue);
  /// Prepare the copy to become the bone, until `exchange` or `discard_next`. See the functions of the same
  /// name in BoneFollower (`exchange` is its `swap`). `with_emptied` lowers the voxels that milling had
  /// emptied; call it once the copy has its new isovalue, at which `densities` were estimated.
  NextBone without_last_cut(double removed_mm3);
  NextBone with_undone_cut(double removed_mm3);
  NextBone without_all_cuts();
  NextBone without_pieces(std::vector<DensityBlock> without, double removed_mm3);
  NextBone with_emptied(double surroundings, double removed_mm3, const BoneDensities& densities);
  void exchange();
  void discard_next();

 private:
  // Effect of the exchange on the history.
  enum class Step { none, undo, redo, reset, pieces };

  bool put(DensityBlock& block);
  void put_differing();
  NextBone with(const CutHistory::SavedState& state, Step step, double removed_mm3);
  void note_step();

  std::shared_ptr<Volume> bone_;
  std::shared_ptr<Volume> copy_;
  std::function<void(const VoxelBox&)> changed_;
  CutHistory history_;
  // While the copy is to become the bone: the bricks that differ, the step that causes it, and the volume
  // removed from the bone.
  std::vector<DensityBlock> differing_;
  Step step_ = Step::none;
  double removed_mm3_ = 0;
  // Highest density that a voxel emptied by milling may have kept, at this or an earlier isovalue.
  float emptied_ = std::numeric_limits<float>::lowest();
};

}  // namespace osteomill
