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
  static constexpr int kSupportingPointsPerTick = 1500;
  /// About the number of points that a tick builds in bricks that the tool meets for the first time.
  static constexpr int kBuiltPointsPerTick = 2500;
  static constexpr std::size_t kMaxSupporting = 1024;

  /// Adds bricks. They wait in one box, and each brick of a box has its turn, one after the other.
  void add(const VoxelBox& bricks);
  /// Takes out the next brick, if any waits.
  std::optional<VoxelIndex> next();
  bool is_empty() const { return walked_.empty() && waiting_.empty(); }
  /// Returns how many bricks wait, including those on which the tool rests.
  std::size_t size() const;

  /// Lists the slot of a brick on which the tool rests, if there is room. If these bricks waited with the
  /// others, the tool would stand still and drop once the last had its turn.
  void add_supporting(std::uint32_t slot) {
    if (supporting_count_ < kMaxSupporting) supporting_[supporting_count_++] = slot;
  }
  void clear_supporting() { supporting_count_ = 0; }
  /// Calls `use(slot)` for the supporting bricks whose turn it is. They take turns over enough calls that
  /// each call does about kSupportingPointsPerTick points, a brick costing `cost_of(slot)`. Neighbours, whose
  /// slots follow one another, have their turns in different calls.
  template <typename CostOf, typename Use>
  void update_supporting_in_turns(const CostOf& cost_of, const Use& use) {
    int cost = 0;
    for (std::size_t n = 0; n < supporting_count_; ++n) cost += cost_of(supporting_[n]);
    const auto turns = static_cast<std::uint32_t>(1 + cost / kSupportingPointsPerTick);
    ++turn_;
    supporting_pending_ = 0;
    for (std::size_t n = 0; n < supporting_count_; ++n) {
      if ((turn_ + supporting_[n]) % turns == 0) {
        use(supporting_[n]);
      } else {
        ++supporting_pending_;
      }
    }
  }

  /// Begins a tick with a budget of kBuiltPointsPerTick; before the first tick there is no bound. Returns
  /// whether bricks wait though none were added since the tick before.
  bool begin_tick() {
    build_budget_ = kBuiltPointsPerTick;
    return !std::exchange(added_, false) && !is_empty();
  }
  bool has_build_budget() const { return build_budget_ > 0; }
  void spend_build_budget(int points) { build_budget_ -= points; }

 private:
  VoxelBox waiting_;
  // The box whose bricks have their turns, and the next of them.
  VoxelBox walked_;
  VoxelIndex next_;
  bool added_ = false;
  std::array<std::uint32_t, kMaxSupporting> supporting_{};
  std::size_t supporting_count_ = 0;
  std::size_t supporting_pending_ = 0;
  std::uint32_t turn_ = 0;
  int build_budget_ = std::numeric_limits<int>::max();
};

}  // namespace osteomill
