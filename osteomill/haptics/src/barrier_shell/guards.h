#pragma once

#include <vector>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/structure_distance.h"

#include "barrier_shell/barrier.h"
#include "energy_sum.h"

namespace osteomill::barrier_shell {

/// Holds the burr off structures by a barrier of the distance between its centre and each: its surface stays
/// `guard_mm` less `kYield_mm` away, whatever presses on it. The barrier is one more energy of the tool's
/// place, so a tool that is held by it is as passive as one held by bone. Safe in the haptic tick, except for
/// the constructor.
class Guards {
 public:
  /// The most by which a burr comes nearer than its guard.
  static constexpr double kYield_mm = 0.05;

  Guards() = default;
  /// Takes the structures that have a guard; there may be none. They outlive this.
  Guards(const NoGoDistances* structures, const MillingTool& tool);

  bool empty() const noexcept { return guards_.empty(); }
  /// Begins with the burr at this place. A guard within which it lies already is as much smaller as needed to
  /// leave it alone.
  void begin_at(const Vec3& burr_W) noexcept;
  /// Lets guards that began smaller grow after the burr as it goes away. None that touches it grows, so
  /// nothing is pushed.
  void follow(const Vec3& burr_W) noexcept;
  /// Returns whether no guard is met at this place, nor by any move of this length from it.
  bool are_clear(const Vec3& burr_W, double move_mm) const noexcept;
  /// Returns the share of a move that leaves the burr a part of its distance to each guard.
  double share_kept(const Vec3& burr_W, const Vec3& move_W_mm) const noexcept;
  /// Adds the energy of the guards, and returns it.
  double add_to(EnergySum& sum, const Pose& X_WT) const noexcept;

 private:
  struct Guard {
    const StructureDistance* structure;
    // The least distance of the burr's centre, and the one for now.
    double whole_mm;
    double least_mm;
    double gap_mm(const Vec3& burr_W) const noexcept {
      return structure->slope_from(burr_W).distance_mm - least_mm;
    }
  };

  std::vector<Guard> guards_;
};

}  // namespace osteomill::barrier_shell
