#pragma once

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/milling/burr_mill.h"

namespace osteomill {

/// Returns the power of a cutting force as a fraction of its power at the burr's rim: 3/4 if the equator
/// cuts, 1/2 if the slower pole does. `ahead_W` (pressing direction) and `shaft_W` are unit vectors. The cut
/// is distributed over the leading half of the ball as in BurrMill, by the cosine of the angle to `ahead_W`.
/// The resistance on each surface element is proportional to its speed.
double rim_power_fraction(const Vec3& ahead_W, const Vec3& shaft_W) noexcept;

/// Returns the part of the burr's force that pays for removal. Zero if the spindle is off, so that the mill
/// drops its unspent budget as if the burr were lifted. Otherwise the force times `rim_power_fraction`, or
/// all of it if energy is constant (no `MillingSettings::chips`) and there is no reaction
/// (`MillingSettings::reaction_share` is 0). Safe in the haptic tick.
Vec3 paying_force_W_N(const MillingSettings& settings, const Pose& X_WT, const Vec3& burr_force_W_N,
                      bool spindle_on) noexcept;

/// Coefficient of friction of a spinning shaft on bone. Assumed: no measurement was found.
inline constexpr double kShaftFriction = 0.2;

/// Drag of bone on the spinning shaft.
struct ShaftDrag {
  /// On the hand, about the burr's centre, in W.
  Wrench wrench;
  /// Load torque on the spindle.
  double torque_Nmm = 0;
};

/// Returns the drag: kShaftFriction times the contact force across the shaft, against the rotation. `contact`
/// is the wrench of bone on the shaft about the burr's centre, in W. Zero if that force is below 0.01 N. Safe
/// in the haptic tick.
ShaftDrag shaft_drag(const MillingTool& tool, const Pose& X_WT, const Wrench& contact) noexcept;

/// Computes the reaction of cutting on the hand. The burr turns clockwise as seen from the hand; bone resists
/// along its surface velocity, so the burr pulls sideways and its torque turns the handle. The power of the
/// torque about the spindle equals the cutting power. Smoothed over 10 ms, so that the hand feels no steps as
/// single voxels are cut. At most twice `reaction_share` of the burr's force, because the mill carries over
/// no more than 10 ms of pressing. Not published in this form; see docs/algorithms.md for related work.
class CuttingReaction {
 public:
  /// The reaction is zero if `reaction_share` or the removal rate is 0.
  CuttingReaction(const MillingSettings& settings, double burr_radius_mm)
      : settings_(settings), radius_mm_(burr_radius_mm) {}

  /// Returns the reaction on the hand in the last tick, in W about the burr's centre.
  const Wrench& wrench() const { return wrench_; }
  /// Updates the reaction from the bone removed in `dt_s` with this force on the bone. Call after each tick.
  /// Safe in the haptic tick.
  void follow(const Pose& X_WT, const Vec3& burr_force_W_N, double removed_mm3, double dt_s) noexcept;
  /// Updates the reaction from the part of the force that holds back the burr's rim (the rim's tangential
  /// force is `reaction_share` times that) and from the drag on the shaft.
  void update_from_force(const Pose& X_WT, const Vec3& burr_force_W_N, double holding_N, double dt_s,
                         const Wrench& shaft_drag = {}) noexcept;
  /// Resets to the state before the first tick.
  void reset() noexcept { wrench_ = {}; }

 private:
  MillingSettings settings_;
  double radius_mm_;
  Wrench wrench_;
};

}  // namespace osteomill
