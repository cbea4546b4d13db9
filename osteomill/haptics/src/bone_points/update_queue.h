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

/// Schedules the update of bricks after densities fell, separately for bricks that support the tool. Bounds
/// the work per tick, counted in points, in proportion to the tick's length, so that a faster loop does the
/// same work per second. Holds no pointers; all of it is safe in the haptic tick.
class UpdateQueue {
 public:
  /// Share of the load from which a supporting brick is updated at every call. If such bricks took turns over
  /// two calls, the tool would sink unevenly: a buzz at half the haptic rate of up to 0.04 N mm (tooth, 3 N).
  /// With 1/50, 0.008 N mm remain; with 1/100, 0.005, as if all bricks were updated. At most 1/share bricks
  /// reach it.
  static constexpr float kAlwaysUpdateShare = 0.01f;
  /// Approximate number of points that a 1 ms tick would update in supporting bricks if all of them took
  /// turns, and the largest number in those updated at every call. (Tried: updating a brick only once its
  /// surface has sunk by 2 um, judged by bone lost per area. It halved the time but doubled the torque steps,
  /// from 0.14 to 0.28 N mm; tooth, 3 N.)
  static constexpr int kSupportingPointsPerMs = 1500;
  /// Approximate number of points that a 1 ms tick builds in bricks that the tool reaches for the first time.
  static constexpr int kBuiltPointsPerMs = 2500;
  static constexpr std::size_t kMaxSupporting = 1024;

  explicit UpdateQueue(double tick_s = 1e-3)
      : supporting_points_(points_in(tick_s, kSupportingPointsPerMs)),
        built_points_(points_in(tick_s, kBuiltPointsPerMs)) {}

  /// Adds bricks. Merges all pending bricks into one box, and visits each brick of a box once.
  void add(const VoxelBox& bricks);
  /// Removes and returns the next pending brick, if any.
  std::optional<VoxelIndex> next();
  bool is_empty() const { return active_box_.empty() && pending_box_.empty(); }
  /// Returns the number of pending bricks, including supporting ones.
  std::size_t size() const;

  /// Adds the slot of a brick that supports the tool, with its load in any unit, if there is space. If these
  /// bricks waited with the others, the tool would stop and then drop when the last was updated.
  void add_supporting(std::uint32_t slot, float load) {
    if (supporting_count_ == kMaxSupporting) return;
    supporting_[supporting_count_++] = {slot, load};
    load_ += load;
  }
  void clear_supporting() {
    supporting_count_ = 0;
    load_ = 0;
  }
  /// Calls `use(slot)` for the supporting bricks that are due; a brick costs `cost_of(slot)` points. Bricks
  /// that bear at least kAlwaysUpdateShare of the load are due at every call; if together they exceed the
  /// budget of a tick (kSupportingPointsPerMs), as in fine voxels, only the most loaded ones are. The others
  /// take turns, over as many calls as all bricks would need at that many points per call. Neighbours, whose
  /// slots are consecutive, are due in different calls.
  template <typename CostOf, typename Use>
  void update_supporting_in_turns(const CostOf& cost_of, const Use& use) {
    const float least_load = always_update_load(cost_of);
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

  /// Begins a tick and sets its budget of points to build; before the first tick it is unlimited. Returns
  /// whether bricks are pending though none were added since the last tick.
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
  // Returns the smallest load at which a brick is updated at every call.
  template <typename CostOf>
  float always_update_load(const CostOf& cost_of) const {
    for (float share = kAlwaysUpdateShare; share < 1; share *= 2) {
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
  VoxelBox pending_box_;
  // The box being visited, and its next brick.
  VoxelBox active_box_;
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
