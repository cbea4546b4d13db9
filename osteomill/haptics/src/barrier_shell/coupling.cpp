#include "barrier_shell/coupling.h"

#include <cmath>

#include "tool_move.h"

namespace osteomill::barrier_shell {

namespace {

// Energy, force per stretch and stiffness of a spring at a stretch s.
struct Spring {
  double energy;
  double per_stretch;  // force / s
  double stiffness;    // d force / d s
};

Spring spring(double stiffness, double max, double stretch) {
  const double bend = max / stiffness;
  if (stretch <= bend) return {0.5 * stiffness * stretch * stretch, stiffness, stiffness};
  return {max * (stretch - 0.5 * bend), max / stretch, 0};
}

// Returns the Hessian of a spring's energy for a stretch vector s; its part perpendicular to s is scaled by
// `across`.
Mat3 hessian(const Spring& spring, const Vec3& s, double across) {
  const double length = s.norm();
  const Vec3 unit = length > 0 ? Vec3(s / length) : Vec3::Zero().eval();
  const Mat3 along = unit * unit.transpose();
  return spring.stiffness * along + across * spring.per_stretch * (Mat3::Identity() - along);
}

}  // namespace

Wrench Coupling::wrench_on_hand(const Pose& X_WT, const Pose& X_WD) const noexcept {
  const ToolMove stretch = move_between(X_WD, X_WT);
  return {spring(translational_N_per_mm, max_force_N, stretch.translation_mm.norm()).per_stretch *
              stretch.translation_mm,
          spring(torsional_Nmm_per_rad, max_torque_Nmm, stretch.rotation_rad.norm()).per_stretch *
              stretch.rotation_rad};
}

double Coupling::energy_Nmm(const Pose& X_WT, const Pose& X_WD) const noexcept {
  const ToolMove stretch = move_between(X_WD, X_WT);
  return spring(translational_N_per_mm, max_force_N, stretch.translation_mm.norm()).energy +
         spring(torsional_Nmm_per_rad, max_torque_Nmm, stretch.rotation_rad.norm()).energy;
}

EnergySum Coupling::sum(const Pose& X_WT, const Pose& X_WD) const noexcept {
  const Quat to_T = X_WT.orientation.conjugate();
  const ToolMove stretch = move_between(X_WD, X_WT);
  const Vec3 s = to_T * stretch.translation_mm, theta = to_T * stretch.rotation_rad;
  const Spring pull = spring(translational_N_per_mm, max_force_N, s.norm());
  const Spring twist = spring(torsional_Nmm_per_rad, max_torque_Nmm, theta.norm());
  // Rate at which a rotation perpendicular to theta changes theta: (angle / 2) cot(angle / 2).
  const double half = 0.5 * theta.norm();
  const double across = half < 1e-4 ? 1 : half / std::tan(half);
  EnergySum sum;
  sum.energy_Nmm = pull.energy + twist.energy;
  sum.gradient << pull.per_stretch * s, twist.per_stretch * theta;
  sum.convex.topLeftCorner<3, 3>() = hessian(pull, s, 1);
  sum.convex.bottomRightCorner<3, 3>() = hessian(twist, theta, across);
  return sum;
}

}  // namespace osteomill::barrier_shell
