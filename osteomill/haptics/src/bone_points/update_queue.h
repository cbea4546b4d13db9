#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Schedules the update of bricks after densities fell: which bricks wait, and on which of them the tool
/// rests. Bounds the work of a tick, counted in points. A value without pointers; all of it is safe in the
/// haptic tick.
class UpdateQueue {
 public:
  /// About the number of points that a tick updates in bricks on which the tool rests. (Tried: updating such
  /// a brick only once its surface has sunk by 2 um, judged by bone lost over area. It took half the time but
  /// doubled the steps of torque, 0.28 N mm for 0.14; tooth, 3 N.)
  static constexpr int kBearingPerTick = 1500;
  /// About the number of points that a tick builds in bricks that the tool meets for the first time.
  static constexpr int kMadePerTick = 2500;
  static constexpr std::size_t kMostBearing = 1024;

  /// Adds bricks. They wait in one box, and each brick of a box has its turn, one after the other.
  void add(const VoxelBox& bricks);
  /// Takes out the next brick, if any waits.
  std::optional<VoxelIndex> next();
  bool is_empty() const { return walked_.empty() && waiting_.empty(); }
  /// Returns how many bricks wait, including those on which the tool rests.
  std::size_t size() const;

  /// Lists the slot of a brick on which the tool rests, if there is room. If these bricks waited with the
  /// others, the tool would stand still and drop once the last had its turn.
  void add_bearing(std::uint32_t slot) {
    if (bearing_count_ < kMostBearing) bearing_[bearing_count_++] = slot;
  }
  void clear_bearing() { bearing_count_ = 0; }
  /// Calls `use(slot)` for the bearing bricks whose turn it is. They take turns over enough calls that each
  /// call does about kBearingPerTick points, a brick costing `cost_of(slot)`. Neighbours, whose slots follow
  /// one another, have their turns in different calls.
  template <typename CostOf, typename Use>
  void take_bearing_turns(const CostOf& cost_of, const Use& use) {
    int cost = 0;
    for (std::size_t n = 0; n < bearing_count_; ++n) cost += cost_of(bearing_[n]);
    const auto turns = static_cast<std::uint32_t>(1 + cost / kBearingPerTick);
    ++turn_;
    bearing_owed_ = 0;
    for (std::size_t n = 0; n < bearing_count_; ++n) {
      if ((turn_ + bearing_[n]) % turns == 0) {
        use(bearing_[n]);
      } else {
        ++bearing_owed_;
      }
    }
  }

  /// Begins a tick, which may make kMadePerTick points; before the first there is no bound. Returns whether
  /// bricks wait though none were added since the tick before.
  bool begin_tick() {
    may_make_ = kMadePerTick;
    return !std::exchange(added_, false) && !is_empty();
  }
  bool may_make() const { return may_make_ > 0; }
  void count_made(int points) { may_make_ -= points; }

 private:
  VoxelBox waiting_;
  // The box whose bricks have their turns, and the next of them.
  VoxelBox walked_;
  VoxelIndex next_;
  bool added_ = false;
  std::array<std::uint32_t, kMostBearing> bearing_{};
  std::size_t bearing_count_ = 0;
  std::size_t bearing_owed_ = 0;
  std::uint32_t turn_ = 0;
  int may_make_ = std::numeric_limits<int>::max();
};

}  // namespace osteomill
