#pragma once

#include <vector>

#include "osteomill/haptics/milling_tool.h"
#include "osteomill/volume/structure_distance.h"

#include "barrier_shell/barrier.h"
#include "energy_sum.h"

namespace osteomill::barrier_shell {

/// Keeps the burr off structures with a barrier on the distance between its centre and each: its surface
/// stays at least `guard_mm` - `kYield_mm` away, whatever the force. The barrier is one more energy of the
/// tool's pose, so holding the tool by it is as passive as holding it by bone. Safe in the haptic tick,
/// except for the constructor.
class NoGoBarriers {
 public:
  /// Largest depth to which the burr enters a guard, mm.
  static constexpr double kYield_mm = 0.05;

  NoGoBarriers() = default;
  /// Uses the structures that have a guard, if any. They must outlive this object.
  NoGoBarriers(const NoGoDistances* structures, const MillingTool& tool);

  bool empty() const noexcept { return no_go_barriers_.empty(); }
  /// Starts with the burr's centre at `burr_W`. Shrinks a guard that the burr is already in until it exerts
  /// no force.
  void begin_at(const Vec3& burr_W) noexcept;
  /// Lets shrunk guards grow back as the burr moves away. A guard in contact does not grow, so it never
  /// pushes the burr.
  void follow(const Vec3& burr_W) noexcept;
  /// Returns whether no guard is in contact at this position, or after any move of this length from it.
  bool is_clear(const Vec3& burr_W, double move_mm) const noexcept;
  /// Returns the share of a move that leaves the burr part of its distance to each guard.
  double safe_step_fraction(const Vec3& burr_W, const Vec3& move_W_mm) const noexcept;
  /// Adds the guards' energy to `sum`, and returns it.
  double add_to(EnergySum& sum, const Pose& X_WT) const noexcept;

 private:
  struct NoGoBarrier {
    const StructureDistance* structure;
    // Minimum distance of the burr's centre, mm: final and current.
    double full_offset_mm;
    double least_mm;
    double gap_mm(const Vec3& burr_W) const noexcept {
      return structure->distance_and_gradient_from(burr_W).distance_mm - least_mm;
    }
  };

  std::vector<NoGoBarrier> no_go_barriers_;
};

}  // namespace osteomill::barrier_shell
