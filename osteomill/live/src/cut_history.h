#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "osteomill/volume/density_block.h"

namespace osteomill {

/// Stores bricks as they were before milling: before each cut, for undo, and at the beginning, for reset. An
/// undone cut can be redone until something else is cut. Removing pieces is a cut, too. The bricks of cuts
/// take at most `undo_bytes`; beyond that the oldest cuts are dropped. Memory for the reset is not limited:
/// it grows with the bone touched, not with time. For one thread.
class CutHistory {
 public:
  /// Bricks by place.
  using Bricks = std::unordered_map<std::uint64_t, DensityBlock>;
  /// Bricks to restore, and the volume removed in that state.
  struct SavedState {
    const Bricks& bricks;
    double removed_mm3;
  };

  explicit CutHistory(std::size_t undo_bytes) : max_bricks_(undo_bytes / sizeof(DensityBlock)), cuts_(1) {}

  /// Saves a brick as it was before a change. Drops the undone cuts.
  void save(const DensityBlock& before);
  /// Begins another cut; all milling from now on belongs to it. `removed_mm3` is the volume removed before
  /// it. Does nothing if nothing was cut since the last call.
  void begin_cut(double removed_mm3);
  /// Adds a removal of pieces as a cut of its own: the bricks before it, and how much it lowered each label's
  /// densities (BoneFollower::drops_by_label).
  void add_pieces(const std::vector<DensityBlock>& before, double removed_mm3, std::vector<double> drops);
  /// Sets how much of the last cut was removed as pieces.
  void set_piece_drops(std::vector<double> drops) { cuts_.back().piece_drops = std::move(drops); }

  /// Returns the maximum number of bricks of a cut.
  std::size_t max_bricks() const { return max_bricks_; }
  /// Returns the number of cuts that can be undone.
  std::size_t cuts() const;
  /// Returns the number of undone cuts that can be redone.
  std::size_t undone_cuts() const { return undone_.size(); }
  /// Returns whether any cut is not undone.
  bool is_touched() const { return cuts() > 0 || has_forgotten_cuts_; }
  /// Returns every touched brick with its original densities.
  const Bricks& original_bricks() const { return original_bricks_; }
  /// Returns the summed drops of all removed pieces; empty if there are none.
  std::vector<double> piece_drops() const;

  /// Returns the state before the last cut; without bricks if there is no cut.
  SavedState state_before_last_cut() const;
  SavedState state_before_all_cuts() const { return {original_bricks_, 0}; }
  /// Returns the state after the last undone cut, which must exist.
  SavedState state_after_undone_cut() const;
  /// Record that the last cut was undone, or the last undone cut redone. `were` holds that state's bricks as
  /// they were before the step, `removed_mm3` the volume removed then.
  void record_undo(const std::vector<DensityBlock>& were, double removed_mm3);
  void record_redo(const std::vector<DensityBlock>& were, double removed_mm3);
  /// Drops the whole history after a reset.
  void clear_history();

  /// Adapts to another isovalue, at which voxels that milling had cut down to `emptied` or below would count
  /// as bone: lowers them to `floor`, both in the history and in the returned bricks, which are those of
  /// `grid` that change. Partially cut voxels stay as they are, and with them the surface of the cut.
  std::vector<DensityBlock> clear_emptied_voxels(const DensityGrid& grid, float emptied, double isovalue,
                                                 float floor);

 private:
  // The bone on the other side of a cut: before it or, if it was undone, after it.
  struct Cut {
    Bricks bricks;
    double removed_mm3 = 0;
    std::vector<double> piece_drops;
  };

  void forget_oldest();
  static void exchange(Cut& cut, const std::vector<DensityBlock>& were, double removed_mm3);

  std::size_t max_bricks_;
  Bricks original_bricks_;
  // The last one may be empty; it collects the next cut.
  std::deque<Cut> cuts_;
  std::vector<Cut> undone_;
  // Bricks in `cuts_` and `undone_`.
  std::size_t bricks_in_cuts_ = 0;
  bool has_forgotten_cuts_ = false;
  std::vector<double> forgotten_piece_drops_;
};

}  // namespace osteomill
