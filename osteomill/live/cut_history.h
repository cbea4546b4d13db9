#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

#include "osteomill/volume/density_block.h"

namespace osteomill {

/// What was milled, so that it can be taken back: bricks as they were before, since the beginning, for a
/// reset, and for each cut, for an undo. The cuts' bricks take at most `undo_bytes`; the oldest cuts are then
/// forgotten. Bricks for the reset are not limited: they grow with the bone that was touched, not with time.
/// For one thread.
class CutHistory {
 public:
  /// By the brick's place.
  using Bricks = std::unordered_map<std::uint64_t, DensityBlock>;
  struct Cut {
    Bricks before;
    double removed_before_mm3 = 0;
  };
  /// Taken out of the history, for its bricks to be put into the bone.
  struct Taken {
    Bricks bricks;
    /// What had been removed before it.
    double removed_mm3 = 0;
    /// All of a history that was taken at once.
    std::deque<Cut> cuts;
    /// Whether there had been older ones.
    bool forgotten = false;
  };

  explicit CutHistory(std::size_t undo_bytes) : max_bricks_(undo_bytes / sizeof(DensityBlock)), cuts_(1) {}

  /// A brick as it was, of which something has just changed.
  void keep(const DensityBlock& before);
  /// What comes from now on belongs to another cut; `removed_mm3` is what had been removed before it. Nothing
  /// where nothing was cut since the last call.
  void begin_cut(double removed_mm3);

  /// How many cuts can be taken back.
  std::size_t cuts() const;
  bool touched() const { return !first_.empty(); }
  /// Every brick that was touched, as it was at the beginning.
  const Bricks& first() const { return first_; }

  /// The last cut; without bricks where there is none. With the first of all cuts, all.
  Taken take_last();
  /// All since the beginning, beyond which cuts cannot be taken back.
  Taken take_all();
  /// As it was before `taken` was taken, nothing having been kept since.
  void put_back(Taken taken);

  /// Another isovalue, at which voxels that milling had cut down to `emptied` or below would count as bone:
  /// they go down to `floor`, in all that can be taken back and in the bricks returned, which are those of
  /// `grid` that differ. Voxels that are cut in part stay as they are, and with them the cut's surface.
  std::vector<DensityBlock> keep_emptied(const DensityGrid& grid, float emptied, double isovalue,
                                         float floor);

 private:
  void forget_oldest();

  std::size_t max_bricks_;
  Bricks first_;
  std::deque<Cut> cuts_;
  std::size_t bricks_in_cuts_ = 0;
  bool forgotten_ = false;
};

}  // namespace osteomill
