#pragma once

#include "osteomill/base/pose.h"
#include "osteomill/base/wrench.h"
#include "osteomill/milling/burr_mill.h"

namespace osteomill {

/// Returns the power that a cutting force has at the place where the burr cuts, as a share of its power at
/// the burr's rim: 3/4 if the equator cuts, 1/2 if the pole does, whose speed is lower. `ahead_W`, in which
/// it presses, and `shaft_W` are unit vectors. What is cut lies about `ahead_W` as in BurrMill: on the half
/// ahead, by the cosine of the angle from it. Each piece of the burr is held back in proportion to its speed.
double rim_share(const Vec3& ahead_W, const Vec3& shaft_W) noexcept;

/// Returns the force that pays for what is cut: none if the burr does not turn, so that the mill forgets what
/// it had pressed for as if it were lifted; else the burr's force, less if its pole presses, and all of it if
/// energy is constant (no `MillingSettings::chips`) and there is no reaction
/// (`MillingSettings::reaction_share`). Safe in the haptic tick.
Vec3 paying_force_W_N(const MillingSettings& settings, const Pose& X_WT, const Vec3& burr_force_W_N,
                      bool spindle_on) noexcept;

/// The friction of a spinning shaft on bone. Assumed: no measurement was found.
inline constexpr double kShaftFriction = 0.2;

/// The drag of bone on the spinning shaft.
struct ShaftDrag {
  /// On the hand, about the burr's centre, in W.
  Wrench wrench;
  /// The torque by which it holds the spindle back.
  double torque_Nmm = 0;
};

/// Returns the drag, kShaftFriction times the force across the shaft and against its turning, if `contact` is
/// what bone does to the shaft, about the burr's centre, in W; nothing under 0.01 N. Safe in the haptic tick.
ShaftDrag shaft_drag(const MillingTool& tool, const Pose& X_WT, const Wrench& contact) noexcept;

/// Computes what the hand feels of cutting: the burr, which turns clockwise as the hand sees it, is held back
/// along its speed, so that it pulls sideways along its rim and turns the handle. The power of its torque
/// about the spindle is what the bone cost. Smoothed over 10 ms, so that no grain of the cutting is a step in
/// the hand; at most twice `reaction_share` of what the burr pressed with, since no more than 10 ms of
/// pressing are carried over. Not published in this form; docs/algorithms.md names what is.
class CuttingReaction {
 public:
  /// Makes the reaction; there is none if `reaction_share` or the removal rate is 0.
  CuttingReaction(const MillingSettings& settings, double burr_radius_mm)
      : settings_(settings), radius_mm_(burr_radius_mm) {}

  /// Returns the reaction on the hand, about the burr's centre, as of the last tick.
  const Wrench& wrench() const { return wrench_; }
  /// Takes in, after each tick, what was removed with this force on the bone in `dt_s`. Safe in the haptic
  /// tick.
  void follow(const Pose& X_WT, const Vec3& burr_force_W_N, double removed_mm3, double dt_s) noexcept;
  /// Does so with the part of the force that holds the burr back along its rim by `reaction_share`, and with
  /// the drag on the shaft.
  void follow_paid(const Pose& X_WT, const Vec3& burr_force_W_N, double paid_N, double dt_s,
                   const Wrench& shaft_drag = {}) noexcept;
  /// Forgets the reaction, as before the first tick.
  void reset() noexcept { wrench_ = {}; }

 private:
  MillingSettings settings_;
  double radius_mm_;
  Wrench wrench_;
};

}  // namespace osteomill
