#pragma once

#include "osteomill/haptics/barrier_shell/near_points.h"
#include "osteomill/haptics/bone_points/bone_bricks.h"

namespace osteomill::barrier_shell {

/// How far the tool may move before points have to be gathered again.
struct Room {
  double move_mm = 0;
  double turn_rad = 0;
};

/// The bone near the tool: gathered once and then good for every pose that the room allows. Safe in the
/// haptic tick.
class NearBone {
 public:
  /// Room for `capacity` points at each core.
  explicit NearBone(std::size_t capacity = 0);

  /// Gathers the points that may touch the barrier at `X_WT` or anywhere within the room. Makes bricks.
  void gather(BoneBricks& bricks, const Cores& cores, const Barrier& barrier, const Pose& X_WT,
              const Room& room);
  /// Whether a point was left out for want of room: the tool must not move.
  bool overflowed() const { return ball_.overflowed || cylinder_.overflowed; }
  bool is_empty() const { return ball_.count == 0 && cylinder_.count == 0; }

  struct Energy {
    EnergySum ball;
    EnergySum cylinder;
  };
  /// At a pose within the room of the last gathering.
  Energy energy(const Cores& cores, const Barrier& barrier, const Pose& X_WT);
  /// The share of a move from the pose of the last `energy` that leaves every gathered point 0.1 of its
  /// distance.
  double certified(const MoveT& move, const Barrier& barrier) const;

 private:
  Pose X_WT_gathered_;
  NearPoints ball_;
  NearPoints cylinder_;
};

/// Whether no bone can be within the room of the tool at `X_WT`; makes no bricks, and may say no where it is
/// so.
bool is_clear(BoneBricks& bricks, const Cores& cores, const Barrier& barrier, const Pose& X_WT,
              const Room& room);

}  // namespace osteomill::barrier_shell
