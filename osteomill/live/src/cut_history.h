#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "osteomill/volume/density_block.h"

namespace osteomill {

/// Keeps bricks as they were before they were milled, so that milling can be taken back: as they were before
/// each cut, for an undo, and as they were at the beginning, for a reset. The bricks of cuts take at most
/// `undo_bytes`; beyond that the oldest cuts are forgotten. Those for the reset are not limited: they grow
/// with the bone that was touched, not with time. For one thread.
class CutHistory {
 public:
  /// Bricks by their places.
  using Bricks = std::unordered_map<std::uint64_t, DensityBlock>;
  /// Bricks as they were before milling that can be taken back, and what had been removed by then.
  struct PriorState {
    const Bricks& bricks;
    double removed_mm3;
  };

  explicit CutHistory(std::size_t undo_bytes) : max_bricks_(undo_bytes / sizeof(DensityBlock)), cuts_(1) {}

  /// Keeps a brick as it was, of which something has just changed.
  void save(const DensityBlock& before);
  /// Begins another cut, to which all that is milled from now on belongs; `removed_mm3` is what had been
  /// removed before it. Does nothing if nothing was cut since the last call.
  void begin_cut(double removed_mm3);

  /// Returns how many cuts can be taken back.
  std::size_t cuts() const;
  bool is_touched() const { return !original_bricks_.empty(); }
  /// Returns every brick that was touched, as it was at the beginning.
  const Bricks& original_bricks() const { return original_bricks_; }

  /// Returns the state before the last cut; no bricks if there is none.
  PriorState state_before_last_cut() const;
  PriorState state_before_all_cuts() const { return {original_bricks_, 0}; }
  /// Forget the last cut, or all that was milled since the beginning, after it has been taken back. Without
  /// the first of all cuts nothing is milled any more.
  void drop_last();
  void drop_all();

  /// Adapts to another isovalue, at which voxels that milling had cut down to `emptied` or below would count
  /// as bone: lowers them to `floor`, in all that can be taken back and in the bricks returned, which are
  /// those of `grid` that differ. Voxels that are cut in part stay as they are, and with them the cut's
  /// surface.
  std::vector<DensityBlock> lower_emptied_bricks(const DensityGrid& grid, float emptied, double isovalue,
                                                 float floor);

 private:
  struct Cut {
    Bricks before;
    double removed_before_mm3 = 0;
  };

  void forget_oldest();
  bool last_cut_is_all() const { return cuts() <= 1 && !has_forgotten_cuts_; }

  std::size_t max_bricks_;
  Bricks original_bricks_;
  std::deque<Cut> cuts_;
  std::size_t bricks_in_cuts_ = 0;
  bool has_forgotten_cuts_ = false;
};

}  // namespace osteomill
