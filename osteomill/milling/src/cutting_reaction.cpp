#include "osteomill/milling/cutting_reaction.h"

#include <algorithm>
#include <cmath>

namespace osteomill {

namespace {

constexpr double kSmooth_s = 0.01;
// Smaller values are set to zero, so that a tool in free space gives exactly no wrench.
constexpr double kNothing_N = 1e-4;
constexpr double kNothing_Nmm = 1e-4;
// Means over the unit normals n of a half ball, weighted by their cosine to `ahead`: the mean of n . ahead,
// and the mean of n n^T as an isotropic part and a part along `ahead`.
constexpr double kMeanAlong = 2.0 / 3.0;
constexpr double kAround = 0.25;
constexpr double kAlong = 0.25;

// Each surface element moves along spin x n; the resistance opposes that, at the lever arm r n.
Wrench reaction(const Vec3& ahead_W, const Vec3& shaft_W, double burr_radius_mm, double cutting_N) {
  const Vec3 spin_W = -shaft_W;
  const Vec3 mean_n_n_spin = kAround * spin_W + kAlong * ahead_W.dot(spin_W) * ahead_W;
  return {-cutting_N * kMeanAlong * spin_W.cross(ahead_W),
          -cutting_N * burr_radius_mm * (spin_W - mean_n_n_spin)};
}

}  // namespace

double rim_power_fraction(const Vec3& ahead_W, const Vec3& shaft_W) noexcept {
  const double along = shaft_W.dot(ahead_W);
  return 1 - kAround - kAlong * along * along;
}

Vec3 paying_force_W_N(const MillingSettings& settings, const Pose& X_WT, const Vec3& burr_force_W_N,
                      bool spindle_on) noexcept {
  if (!spindle_on) return Vec3::Zero();
  const double force_N = burr_force_W_N.norm();
  if (!(settings.reaction_share > 0 || settings.chips) || !(force_N > 0)) return burr_force_W_N;
  return rim_power_fraction(burr_force_W_N / force_N, shaft_direction(X_WT)) * burr_force_W_N;
}

ShaftDrag shaft_drag(const MillingTool& tool, const Pose& X_WT, const Wrench& contact) noexcept {
  constexpr double kMinForce_N = 0.01;
  const Vec3 shaft_W = shaft_direction(X_WT);
  const Vec3 across_W_N = contact.force_N - contact.force_N.dot(shaft_W) * shaft_W;
  const double force_N = across_W_N.norm();
  if (!(force_N > kMinForce_N) || !std::isfinite(force_N)) return {};
  const Vec3 to_bone_W = -across_W_N / force_N;
  // Distance along the shaft at which the force produces the contact torque.
  const double lever_mm = std::clamp(contact.torque_Nmm.dot(shaft_W.cross(across_W_N)) / (force_N * force_N),
                                     0.0, tool.shaft_length_mm);
  const Vec3 speed_W = -shaft_W.cross(to_bone_W);
  const Vec3 drag_W_N = -kShaftFriction * force_N * speed_W;
  const Vec3 place_W_mm = lever_mm * shaft_W + tool.shaft_radius_mm * to_bone_W;
  return {{drag_W_N, place_W_mm.cross(drag_W_N)}, kShaftFriction * force_N * tool.shaft_radius_mm};
}

void CuttingReaction::follow(const Pose& X_WT, const Vec3& burr_force_W_N, double removed_mm3,
                             double dt_s) noexcept {
  if (!(settings_.reaction_share > 0) || !(dt_s > 0)) return;
  const double force_N = burr_force_W_N.norm();
  const bool cuts = removed_mm3 > 0 && force_N > 0 && std::isfinite(force_N);
  const double share = cuts ? rim_power_fraction(burr_force_W_N / force_N, shaft_direction(X_WT)) : 1;
  update_from_force(X_WT, burr_force_W_N,
                    cuts ? removed_mm3 / (settings_.removal_rate_mm3_per_Ns * share * dt_s) : 0, dt_s);
}

void CuttingReaction::update_from_force(const Pose& X_WT, const Vec3& burr_force_W_N, double holding_N,
                                        double dt_s, const Wrench& shaft_drag) noexcept {
  if (!(settings_.reaction_share > 0) || !(dt_s > 0)) return;
  Wrench now = shaft_drag;
  const double force_N = burr_force_W_N.norm();
  if (holding_N > 0 && force_N > 0 && std::isfinite(force_N)) {
    now = now + reaction(burr_force_W_N / force_N, shaft_direction(X_WT), radius_mm_,
                         settings_.reaction_share * holding_N);
  }
  const double share = dt_s / (kSmooth_s + dt_s);
  wrench_.force_N += share * (now.force_N - wrench_.force_N);
  wrench_.torque_Nmm += share * (now.torque_Nmm - wrench_.torque_Nmm);
  if (wrench_.force_N.norm() < kNothing_N && wrench_.torque_Nmm.norm() < kNothing_Nmm) reset();
}

}  // namespace osteomill
