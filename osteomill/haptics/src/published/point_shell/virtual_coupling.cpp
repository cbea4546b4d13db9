#include "published/point_shell/virtual_coupling.h"

#include <Eigen/Cholesky>

namespace osteomill::point_shell {

Wrench wrench_on_hand(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                      const ToolMove& stretch_before) noexcept {
  const ToolMove stretch = move_between(X_WD, X_WT);
  const auto damped = [&](const Vec3& now, const Vec3& before) -> Vec3 {
    return now + coupling.damping_ticks * (now - before);
  };
  return {coupling.translational_N_per_mm * damped(stretch.translation_mm, stretch_before.translation_mm),
          coupling.torsional_Nmm_per_rad * damped(stretch.rotation_rad, stretch_before.rotation_rad)};
}

ToolMove balancing_move(const VirtualCoupling& coupling, const Pose& X_WT, const Pose& X_WD,
                        const ToolMove& stretch_before, const EnergySum& contacts) noexcept {
  // Net force and torque at X_WT.
  const Wrench pull = wrench_on_hand(coupling, X_WT, X_WD, stretch_before);
  Vector6 net;
  net << -contacts.gradient.head<3>() - pull.force_N, -contacts.gradient.tail<3>() - pull.torque_Nmm;
  // Minus their derivatives. The coupling's torque is linear in the rotation vector between tool and device;
  // neglects that rotation vectors do not simply add (a relative error of half the angle between tool and
  // device).
  Matrix6 stiffness = contacts.convex;
  const double damped = 1 + coupling.damping_ticks;
  stiffness.topLeftCorner<3, 3>().diagonal().array() += damped * coupling.translational_N_per_mm;
  stiffness.bottomRightCorner<3, 3>().diagonal().array() += damped * coupling.torsional_Nmm_per_rad;
  // Symmetric and positive definite: the contacts add only squares.
  const Vector6 move = stiffness.ldlt().solve(net);
  return {move.head<3>(), move.tail<3>()};
}

}  // namespace osteomill::point_shell
