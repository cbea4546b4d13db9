#include "published/point_shell/virtual_coupling.h"

#include <gtest/gtest.h>

namespace osteomill::point_shell {
namespace {

constexpr VirtualCoupling kCoupling{2.0, 1000.0};

TEST(VirtualCoupling, MovesToTheDeviceWithoutContact) {
  const Pose X_WT{{1, 2, 3}, quaternion_from_rotation_vector({0.1, 0.2, 0.3})};
  const Pose X_WD{{1.5, 1, 3.2}, quaternion_from_rotation_vector({0.3, -0.4, 0.3})};
  const Pose after = moved(X_WT, balancing_move(kCoupling, X_WT, X_WD, {}, {}));
  EXPECT_LT((after.position_mm - X_WD.position_mm).norm(), 1e-12);
  EXPECT_LT(rotation_vector(after.orientation * X_WD.orientation.conjugate()).norm(), 1e-12);
}

// One point under the burr makes two springs in series between the device and the bone.
TEST(VirtualCoupling, PointOnTheAxisActsAsTwoSpringsInSeries) {
  const Pose X_WT{{0, 0, 0}, Quat::Identity()};
  const Pose X_WD{{0, 0, -0.7}, Quat::Identity()};
  constexpr double kPoint = 8.0, kDepth = 0.1;
  EnergySum contacts;
  add_contact(contacts, kPoint * kDepth, kPoint, {0, 0, -1}, {0, 0, -1.4});
  const ToolMove move = balancing_move(kCoupling, X_WT, X_WD, {}, contacts);
  // The point is unloaded 0.1 above: the device is 0.8 below that, and pushes with 2 * 8 / (2 + 8) * 0.8 N.
  constexpr double kForce = 2.0 * 8.0 / 10.0 * 0.8;
  EXPECT_NEAR(move.translation_mm.z(), -0.7 + kForce / 2.0, 1e-12);
  EXPECT_LT(move.rotation_rad.norm(), 1e-15);
  const Wrench wrench = wrench_on_hand(kCoupling, moved(X_WT, move), X_WD, {});
  EXPECT_NEAR(wrench.force_N.z(), kForce, 1e-12);
  EXPECT_LT(wrench.torque_Nmm.norm(), 1e-12);
}

// One point on the shaft at the lever arm L sees the coupling's two springs in series, 1/k + L^2/k_r.
TEST(VirtualCoupling, PointAtALeverSharesLoadBetweenForceAndTorque) {
  constexpr double kPoint = 50.0, kDepth = 0.02, kLever = 12.0;
  EnergySum contacts;
  add_contact(contacts, kPoint * kDepth, kPoint, {-1, 0, 0}, {-1, 0, kLever});
  const ToolMove move = balancing_move(kCoupling, {}, {}, {}, contacts);
  const double compliance = 1 / 2.0 + kLever * kLever / 1000.0 + 1 / kPoint;
  const double force = kDepth / compliance;
  const Wrench wrench = wrench_on_hand(kCoupling, moved({}, move), {}, {});
  EXPECT_NEAR(wrench.force_N.x(), force, 1e-12);
  EXPECT_NEAR(wrench.torque_Nmm.y(), kLever * force, 1e-9);
}

// A spring of 2 N/mm with a damper of 3 ticks: a stretch of 0.5 mm that grew by 0.1 mm in the tick gives 2
// (0.5 + 3 * 0.1) N. The balancing move takes the damper into account too.
TEST(VirtualCoupling, DamperExtrapolatesTheStretchOfTheLastTick) {
  constexpr VirtualCoupling kDamped{2.0, 1000.0, 3};
  const ToolMove before{{0, 0, 0.4}, {0.01, 0, 0}};
  const Pose X_WT{{0, 0, 0.5}, quaternion_from_rotation_vector({0.02, 0, 0})};
  const Wrench wrench = wrench_on_hand(kDamped, X_WT, {}, before);
  EXPECT_NEAR(wrench.force_N.z(), 2 * 0.8, 1e-12);
  EXPECT_NEAR(wrench.torque_Nmm.x(), 1000 * 0.05, 1e-9);
  EnergySum contacts;
  add_contact(contacts, 4 * 0.3, 4, {0, 0, -1}, {0, 0, 0});
  const Pose after = moved(X_WT, balancing_move(kDamped, X_WT, {}, before, contacts));
  const double pushed_N = 4 * (0.3 - (after.position_mm.z() - 0.5));
  EXPECT_NEAR(wrench_on_hand(kDamped, after, {}, before).force_N.z(), pushed_N, 1e-9);
}

}  // namespace
}  // namespace osteomill::point_shell
