#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "osteomill/volume/density_block.h"

namespace osteomill {

/// Keeps bricks as they were before they were milled, so that milling can be taken back: as they were before
/// each cut, for an undo, and as they were at the beginning, for a reset. A cut that was taken back can be
/// made again until something else is cut. The removal of pieces is a cut, too. The bricks of cuts take at
/// most `undo_bytes`; beyond that the oldest cuts are forgotten. Those for the reset are not limited: they
/// grow with the bone that was touched, not with time. For one thread.
class CutHistory {
 public:
  /// Bricks by their places.
  using Bricks = std::unordered_map<std::uint64_t, DensityBlock>;
  /// Bricks as they are to be put back, and what was removed when they were like that.
  struct SavedState {
    const Bricks& bricks;
    double removed_mm3;
  };

  explicit CutHistory(std::size_t undo_bytes) : max_bricks_(undo_bytes / sizeof(DensityBlock)), cuts_(1) {}

  /// Keeps a brick as it was, of which something has just changed. What was taken back is then over.
  void save(const DensityBlock& before);
  /// Begins another cut, to which all that is milled from now on belongs; `removed_mm3` is what had been
  /// removed before it. Does nothing if nothing was cut since the last call.
  void begin_cut(double removed_mm3);
  /// Adds the removal of pieces as a cut of its own: the bricks as they were before, and by how much it
  /// lowered each label's densities (BoneFollower::drops_by_label).
  void add_pieces(const std::vector<DensityBlock>& before, double removed_mm3, std::vector<double> drops);
  /// Says of the last cut how much of it was pieces.
  void set_piece_drops(std::vector<double> drops) { cuts_.back().piece_drops = std::move(drops); }

  /// Returns how many bricks a cut may have.
  std::size_t max_bricks() const { return max_bricks_; }
  /// Returns how many cuts can be taken back.
  std::size_t cuts() const;
  /// Returns how many cuts that were taken back can be made again.
  std::size_t undone_cuts() const { return undone_.size(); }
  /// Returns whether anything that was cut is not taken back.
  bool is_touched() const { return cuts() > 0 || has_forgotten_cuts_; }
  /// Returns every brick that was touched, as it was at the beginning.
  const Bricks& original_bricks() const { return original_bricks_; }
  /// Returns the sum of the drops of all pieces that are removed; empty if there are none.
  std::vector<double> piece_drops() const;

  /// Returns the state before the last cut; no bricks if there is none.
  SavedState state_before_last_cut() const;
  SavedState state_before_all_cuts() const { return {original_bricks_, 0}; }
  /// Returns the state after the cut that was taken back last. Only if there is one.
  SavedState state_after_undone_cut() const;
  /// Take note that the last cut was taken back, or the one taken back last was made again. The bricks of
  /// that state are given as they were before, and `removed_mm3` of then.
  void take_back_last(const std::vector<DensityBlock>& were, double removed_mm3);
  void make_again(const std::vector<DensityBlock>& were, double removed_mm3);
  /// Forgets all that was milled since the beginning, after it has been taken back.
  void drop_all();

  /// Adapts to another isovalue, at which voxels that milling had cut down to `emptied` or below would count
  /// as bone: lowers them to `floor`, in all that can be taken back and in the bricks returned, which are
  /// those of `grid` that differ. Voxels that are cut in part stay as they are, and with them the cut's
  /// surface.
  std::vector<DensityBlock> lower_emptied_bricks(const DensityGrid& grid, float emptied, double isovalue,
                                                 float floor);

 private:
  // The bone on the other side of a cut: before it, or after it if it was taken back.
  struct Cut {
    Bricks bricks;
    double removed_mm3 = 0;
    std::vector<double> piece_drops;
  };

  void forget_oldest();
  static void exchange(Cut& cut, const std::vector<DensityBlock>& were, double removed_mm3);

  std::size_t max_bricks_;
  Bricks original_bricks_;
  // The last one may be empty, for what comes.
  std::deque<Cut> cuts_;
  std::vector<Cut> undone_;
  // The bricks of both.
  std::size_t bricks_in_cuts_ = 0;
  bool has_forgotten_cuts_ = false;
  std::vector<double> forgotten_piece_drops_;
};

}  // namespace osteomill
