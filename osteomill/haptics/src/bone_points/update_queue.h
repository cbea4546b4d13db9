#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "osteomill/volume/grid_geometry.h"

namespace osteomill {

/// Schedules the update of bricks after densities fell: which bricks wait, and on which of them the tool
/// rests. Bounds the work of a tick, counted in points, in proportion to its length, so that a faster loop
/// does the same work in a second. A value without pointers; all of it is safe in the haptic tick.
class UpdateQueue {
 public:
  /// Share of the load from which a supporting brick is updated at every call. In turns of two calls such
  /// bricks let the tool sink unevenly, a buzz at half the haptic rate of up to 0.04 N mm (tooth, 3 N); with
  /// 1/50 0.008 N mm are left, with 1/100 0.005, as if all were updated. No more than 1/share bricks have it.
  static constexpr float kBearingShare = 0.01f;
  /// About the number of points that a tick of 1 ms would update in the bricks on which the tool rests if all
  /// took turns. (Tried: updating such a brick only once its surface has sunk by 2 um, judged by bone lost
  /// over area. It took half the time but doubled the steps of torque, 0.28 N mm for 0.14; tooth, 3 N.)
  static constexpr int kSupportingPointsPerMs = 1500;
  /// About the number of points that a tick of 1 ms builds in bricks that the tool meets for the first time.
  static constexpr int kBuiltPointsPerMs = 2500;
  static constexpr std::size_t kMaxSupporting = 1024;

  explicit UpdateQueue(double tick_s = 1e-3)
      : supporting_points_(points_in(tick_s, kSupportingPointsPerMs)),
        built_points_(points_in(tick_s, kBuiltPointsPerMs)) {}

  /// Adds bricks. They wait in one box, and each brick of a box has its turn, one after the other.
  void add(const VoxelBox& bricks);
  /// Takes out the next brick, if any waits.
  std::optional<VoxelIndex> next();
  bool is_empty() const { return walked_.empty() && waiting_.empty(); }
  /// Returns how many bricks wait, including those on which the tool rests.
  std::size_t size() const;

  /// Lists the slot of a brick on which the tool rests with a load, in any unit, if there is room. If these
  /// bricks waited with the others, the tool would stand still and drop once the last had its turn.
  void add_supporting(std::uint32_t slot, float load) {
    if (supporting_count_ == kMaxSupporting) return;
    supporting_[supporting_count_++] = {slot, load};
    load_ += load;
  }
  void clear_supporting() {
    supporting_count_ = 0;
    load_ = 0;
  }
  /// Calls `use(slot)` for the supporting bricks whose turn it is, a brick costing `cost_of(slot)` points.
  /// Those that bear kBearingShare of the load have it at every call; if together these cost more than
  /// a tick may (kSupportingPointsPerMs), as in fine voxels, those that bear the most. The others take turns,
  /// over as many calls as all bricks would need to do that many points in each. Neighbours, whose slots
  /// follow one another, have their turns in different calls.
  template <typename CostOf, typename Use>
  void update_supporting_in_turns(const CostOf& cost_of, const Use& use) {
    const float least_load = bearing_load(cost_of);
    const auto turns = static_cast<std::uint32_t>(1 + cost_from(0, cost_of) / supporting_points_);
    ++turn_;
    supporting_pending_ = 0;
    for (std::size_t n = 0; n < supporting_count_; ++n) {
      const Supporting& brick = supporting_[n];
      if (brick.load >= least_load || (turn_ + brick.slot) % turns == 0) {
        use(brick.slot);
      } else {
        ++supporting_pending_;
      }
    }
  }

  /// Begins a tick with its budget of points to build; before the first tick there is no bound. Returns
  /// whether bricks wait though none were added since the tick before.
  bool begin_tick() {
    build_budget_ = built_points_;
    return !std::exchange(added_, false) && !is_empty();
  }
  bool has_build_budget() const { return build_budget_ > 0; }
  void spend_build_budget(int points) { build_budget_ -= points; }

 private:
  static int points_in(double tick_s, int per_ms) {
    return std::max(1, static_cast<int>(std::lround(1e3 * tick_s * per_ms)));
  }
  // Returns the least load with which a brick is updated at every call.
  template <typename CostOf>
  float bearing_load(const CostOf& cost_of) const {
    for (float share = kBearingShare; share < 1; share *= 2) {
      if (cost_from(share * load_, cost_of) <= supporting_points_) return share * load_;
    }
    return std::numeric_limits<float>::infinity();
  }
  template <typename CostOf>
  int cost_from(float least_load, const CostOf& cost_of) const {
    int cost = 0;
    for (std::size_t n = 0; n < supporting_count_; ++n)
      if (supporting_[n].load >= least_load) cost += cost_of(supporting_[n].slot);
    return cost;
  }

  int supporting_points_;
  int built_points_;
  VoxelBox waiting_;
  // The box whose bricks have their turns, and the next of them.
  VoxelBox walked_;
  VoxelIndex next_;
  bool added_ = false;
  struct Supporting {
    std::uint32_t slot = 0;
    float load = 0;
  };
  std::array<Supporting, kMaxSupporting> supporting_{};
  std::size_t supporting_count_ = 0;
  float load_ = 0;
  std::size_t supporting_pending_ = 0;
  std::uint32_t turn_ = 0;
  int build_budget_ = std::numeric_limits<int>::max();
};

}  // namespace osteomill
