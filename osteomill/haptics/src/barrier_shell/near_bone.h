#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "barrier_shell/near_points.h"
#include "bone_points/bone_bricks.h"

namespace osteomill::barrier_shell {

/// Size of a motion: distance and angle. The leeway of gathered points is the largest motion for which they
/// are complete.
struct MoveSize {
  double move_mm = 0;
  double turn_rad = 0;
};

/// Bone near the tool's parts, measured at one pose.
struct MeasuredBone {
  /// Allocates for as many points per part as NearBone.
  explicit MeasuredBone(std::size_t capacity = 0) : ball(capacity), cylinder(capacity) {}

  MeasuredPoints ball;
  MeasuredPoints cylinder;

  /// Returns the largest share of any point's distance that a move from that pose uses up; `barrier` gives
  /// the smallest distance that counts.
  double max_use(const Vector6& move_T, const Barrier& barrier) const noexcept;
};

/// Bone near a tool's ball and cylinder: gathered once, then valid for every pose within its leeway. Safe in
/// the haptic tick.
class NearBone {
 public:
  /// Allocates for `capacity` points per part. The ball uses the bricks' fine points; the cylinder uses the
  /// coarse ones, or the fine ones if `fine_at_cylinder`.
  explicit NearBone(std::size_t capacity = 0, bool fine_at_cylinder = false);

  /// Gathers the points that may come within `reach_mm` of a part at `X_WT` or anywhere within the leeway.
  /// Builds missing bricks within the tick's budget.
  void gather(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
              const MoveSize& leeway) noexcept;
  /// Returns whether points may be missing, for lack of space or because a brick is not built yet; the tool
  /// must not move then.
  bool is_incomplete() const noexcept { return brick_missing_ || ball_.overflowed || cylinder_.overflowed; }
  bool is_empty() const noexcept { return point_count() == 0; }
  /// Returns the number of points in an evaluation.
  std::size_t point_count() const noexcept { return ball_.count + cylinder_.count; }

  /// Measures the points at a pose within the leeway of the last gathering.
  void measure(const Cores& cores, const Barrier& barrier, const Pose& X_WT,
               MeasuredBone& measured) const noexcept;
  /// Lists in `bricks` those that support the tool: with points measured since the last gathering at less
  /// than `within_mm` from a part, and the approximate load on each.
  void list_supporting(const MeasuredBone& measured, double within_mm, BoneBricks& bricks) const noexcept;

 private:
  // A brick's slot, and the index of its first point at each part.
  struct GatheredBrick {
    std::uint32_t slot;
    std::size_t at_ball;
    std::size_t at_cylinder;
  };

  bool fine_at_cylinder_;
  // Gathered bricks: the first brick_count_ entries.
  std::vector<GatheredBrick> bricks_;
  std::size_t brick_count_ = 0;
  bool brick_missing_ = false;
  Pose X_WT_gathered_;
  NearPoints ball_;
  NearPoints cylinder_;
};

/// Returns true only if there is no bone within `reach_mm` of the tool at `X_WT` or anywhere within the
/// leeway; may return false in free space. Classifies octree nodes but builds no bricks.
bool check_clearance(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
                     const MoveSize& leeway) noexcept;

}  // namespace osteomill::barrier_shell
