#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "barrier_shell/near_points.h"
#include "bone_points/bone_bricks.h"

namespace osteomill::barrier_shell {

/// The size of a move: how far, and by which angle. The leeway of gathered points is the greatest move for
/// which they suffice.
struct MoveSize {
  double move_mm = 0;
  double turn_rad = 0;
};

/// The bone near the tool's parts as measured from one pose.
struct MeasuredBone {
  /// Makes room for as many points at each part as NearBone has.
  explicit MeasuredBone(std::size_t capacity = 0) : ball(capacity), cylinder(capacity) {}

  MeasuredPoints ball;
  MeasuredPoints cylinder;

  /// Returns the greatest share of any point's distance that a move from that pose by a barrier may use up.
  double max_use(const Vector6& move_T, const Barrier& barrier) const noexcept;
};

/// The bone near a tool's ball and cylinder: gathered once and then good for every pose within its leeway.
/// Safe in the haptic tick.
class NearBone {
 public:
  /// Makes room for `capacity` points at each part. The ball meets the bricks' fine points; the cylinder
  /// meets the coarse ones, or the fine ones if `fine_at_cylinder`.
  explicit NearBone(std::size_t capacity = 0, bool fine_at_cylinder = false);

  /// Gathers the points that may come within `reach_mm` of a part at `X_WT` or anywhere within the leeway.
  /// Makes bricks, as many as a tick may.
  void gather(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
              const MoveSize& leeway) noexcept;
  /// Returns whether a point may have been left out, for want of room or because its brick is not made yet:
  /// the tool must not move then.
  bool is_incomplete() const noexcept { return brick_missing_ || ball_.overflowed || cylinder_.overflowed; }
  bool is_empty() const noexcept { return point_count() == 0; }
  /// Returns how many points a sum goes through.
  std::size_t point_count() const noexcept { return ball_.count + cylinder_.count; }

  /// Measures the points from a pose within the leeway of the last gathering.
  void measure(const Cores& cores, const Barrier& barrier, const Pose& X_WT,
               MeasuredBone& measured) const noexcept;
  /// Lists in `bricks` those that support the tool, with points that were measured nearer than `within_mm` to
  /// a part since the last gathering, and about the load that each bears.
  void list_supporting(const MeasuredBone& measured, double within_mm, BoneBricks& bricks) const noexcept;

 private:
  // A brick's slot, and where its points begin.
  struct GatheredBrick {
    std::uint32_t slot;
    std::size_t at_ball;
    std::size_t at_cylinder;
  };

  bool fine_at_cylinder_;
  // The bricks gathered: the first brick_count_ entries.
  std::vector<GatheredBrick> bricks_;
  std::size_t brick_count_ = 0;
  bool brick_missing_ = false;
  Pose X_WT_gathered_;
  NearPoints ball_;
  NearPoints cylinder_;
};

/// Searches for bone within `reach_mm` of the tool at `X_WT` or anywhere within the leeway. Returns true only
/// if there is none; may return false in free space. Classifies octree nodes but builds no bricks.
bool check_clearance(BoneBricks& bricks, const Cores& cores, double reach_mm, const Pose& X_WT,
                     const MoveSize& leeway) noexcept;

}  // namespace osteomill::barrier_shell
