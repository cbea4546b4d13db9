#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <memory>
#include <unordered_map>
#include <vector>

#include "osteomill/surface/density_handover.h"
#include "osteomill/volume/density_grid.h"

namespace osteomill {

/// A copy of the bone for the thread that draws and saves, kept up from what the haptic thread hands over,
/// and able to take the last cuts back. For one thread.
///
/// What was cut is kept in bricks of 8 x 8 x 8 voxels (2 KiB each) as they were before: since the beginning,
/// for a reset, and for each cut, for an undo. The cuts' bricks take at most `undo_bytes`; the oldest cuts
/// are then forgotten. Bricks for the reset are not limited: they grow with the bone that was touched, not
/// with time.
class MilledCopy {
 public:
  static constexpr std::size_t kUndoBytes = std::size_t{256} << 20;

  explicit MilledCopy(DensityGrid grid, std::size_t undo_bytes = kUndoBytes);

  const DensityGrid& grid() const { return grid_; }
  /// Takes a brick over as it is now. True where any density differs from before.
  bool put(const DensityHandover::Brick& brick);
  /// What comes from now on belongs to another cut; `removed_mm3` is what had been removed before it. Nothing
  /// where nothing was cut since the last call.
  void begin_cut(double removed_mm3);

  /// How many cuts can be taken back.
  std::size_t cuts() const;
  /// Takes the last cut back and returns what had been removed before it; nothing is to be taken back: 0.
  double undo();
  /// As it was at the beginning; cuts cannot be taken back beyond it.
  void reset();
  bool touched() const { return !first_.empty(); }

 private:
  using Densities = std::array<float, 512>;
  using Bricks = std::unordered_map<std::size_t, std::unique_ptr<Densities>>;
  struct Cut {
    Bricks before;
    double removed_before_mm3 = 0;
  };

  std::size_t number_of(const VoxelIndex& first) const;
  template <typename Visit>
  void visit_voxels(std::size_t number, const Visit& visit) const;
  std::unique_ptr<Densities> as_now(std::size_t number) const;
  void restore(const Bricks& bricks);
  void forget_oldest();

  DensityGrid grid_;
  std::array<int, 3> brick_dims_;
  std::size_t greatest_bricks_;
  Bricks first_;
  std::deque<Cut> cuts_;
  std::size_t bricks_in_cuts_ = 0;
};

}  // namespace osteomill
