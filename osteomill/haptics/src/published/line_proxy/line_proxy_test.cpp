#include "published/line_proxy/line_proxy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill::line_proxy {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

constexpr double kTick_s = 1e-3;

LineProxy prepared(const Settings& settings, const Volume& volume) {
  LineProxy algorithm(settings);
  algorithm.prepare({&volume, MillingTool{}});
  return algorithm;
}

// Returns settings with the stiffness that the expected values assume.
Settings soft() {
  Settings settings;
  settings.stiffness_N_per_mm = 2;
  return settings;
}

LineProxy prepared(const Volume& volume) {
  return prepared(soft(), volume);
}

// Returns the pose of a tool whose shaft points along `shaft`.
Pose standing(const Vec3& tip_W, const Vec3& shaft) {
  return {tip_W, smallest_rotation(Vec3::UnitZ(), shaft)};
}

// Moves the device straight from one point to another in `ticks` ticks, holds it equally long, and returns
// the last step.
HapticStep push(LineProxy& algorithm, const Pose& from, const Vec3& to_W, int ticks) {
  HapticStep step;
  for (int n = 0; n <= 2 * ticks; ++n) {
    Pose X_WD = from;
    X_WD.position_mm += std::min(1.0, static_cast<double>(n) / ticks) * (to_W - from.position_mm);
    step = algorithm.step(X_WD, kTick_s);
  }
  return step;
}

TEST(LineProxy, WrenchIsExactlyZeroInFreeSpace) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  LineProxy algorithm = prepared(bone);
  for (int n = 0; n < 500; ++n) {
    const Pose X_WD = standing({3 * std::sin(0.02 * n), 3 * std::cos(0.03 * n), 0.05 + 0.05 * (n % 100)},
                               {0.3 * std::sin(0.01 * n), 0.2, 1});
    const HapticStep step = algorithm.step(X_WD, kTick_s);
    ASSERT_EQ(step.wrench.force_N, Vec3::Zero()) << n;
    ASSERT_EQ(step.wrench.torque_Nmm, Vec3::Zero()) << n;
    ASSERT_EQ(step.burr_force_W_N, Vec3::Zero());
    ASSERT_EQ(step.contacts, 0);
    ASSERT_LT((step.X_WT.position_mm - X_WD.position_mm).norm(), 1e-12);
  }
}

TEST(LineProxy, OnAPlaneTheForceIsStiffnessTimesDepth) {
  const Vec3 axes[] = {{0, 0, 1},          {0, -1, 0},           {1, 1, 0},
                       {1, 1, 1},          {0.3, -0.2, 0.9},     {-0.7, 0.5, 0.4},
                       {0.1, 0.9, 0.2},    {-0.23, 0.95, -0.22}, {-0.13, -0.11, -0.99},
                       {0.2, 0.32, -0.93}, {0.09, -0.98, -0.15}};
  for (const Vec3& axis : axes) {
    const Vec3 normal = axis.normalized();
    const Vec3 foot(0.04, -0.03, 0.06);
    const Volume bone = shape_volume(centred_cube(40, 0.25), plane(foot, normal));
    LineProxy algorithm = prepared(bone);
    for (const double depth_mm : {0.2, 0.5, 1.3}) {
      const HapticStep step =
          push(algorithm, standing(foot + 1.0 * normal, normal), foot - depth_mm * normal, 100);
      const Vec3 expected = 2.0 * depth_mm * normal;
      const double along = step.wrench.force_N.dot(normal);
      EXPECT_NEAR(along / expected.norm(), 1.0, 0.005) << normal.transpose() << " at " << depth_mm;
      EXPECT_LT((step.wrench.force_N - along * normal).norm() / along, 0.01) << normal.transpose();
      EXPECT_EQ(step.burr_force_W_N, -step.wrench.force_N);
      EXPECT_LT(step.wrench.torque_Nmm.norm(), 1e-9);
      EXPECT_EQ(step.contacts, 1);
      EXPECT_LT((step.X_WT.position_mm - (foot + 1.5 * normal)).norm(), 0.03);
    }
  }
}

void slide_round_a_ball(double voxel_mm) {
  const int voxels = static_cast<int>(18.0 / voxel_mm);
  const Volume bone = shape_volume(centred_cube(voxels, voxel_mm), ball(Vec3::Zero(), 8.0));
  Settings settings = soft();
  settings.stiffness_N_per_mm = 1.0;
  LineProxy algorithm = prepared(settings, bone);
  const Vec3 across = Vec3(0.2, 1, -0.3).normalized();
  const Vec3 start = across.cross(Vec3::UnitX()).normalized();
  push(algorithm, standing(9.0 * start, start), 7.5 * start, 100);
  std::vector<double> errors_deg;
  Vec3 force_before = algorithm.step(standing(7.5 * start, start), kTick_s).wrench.force_N;
  double largest_step_N = 0;
  for (int n = 1; n <= 3000; ++n) {
    // 16 mm/s.
    const Vec3 out = quaternion_from_rotation_vector(n * 0.016 / 8.0 * across) * start;
    const Vec3 force = algorithm.step(standing(7.5 * out, out), kTick_s).wrench.force_N;
    errors_deg.push_back(std::acos(std::min(1.0, force.normalized().dot(out))) * 180 / std::numbers::pi);
    largest_step_N = std::max(largest_step_N, (force - force_before).norm());
    force_before = force;
  }
  std::sort(errors_deg.begin(), errors_deg.end());
  EXPECT_LT(errors_deg[1500], 1.0);
  EXPECT_LT(errors_deg[2970], 2.5);
  EXPECT_LT(largest_step_N, 0.005);
}

TEST(LineProxy, ForcePointsOutwardWhenSlidingAroundABall) {
  for (const double voxel_mm : {0.25, 0.2, 0.125}) slide_round_a_ball(voxel_mm);
}

TEST(LineProxy, SlidingOnAPlaneIsFreeOfFriction) {
  const Vec3 normal = Vec3(0.2, 0.1, 1).normalized();
  const Volume bone = shape_volume(centred_cube(64, 0.25), plane(Vec3::Zero(), normal));
  LineProxy algorithm = prepared(bone);
  const Vec3 along = normal.cross(Vec3::UnitY()).normalized();
  push(algorithm, standing(normal - 4 * along, normal), -0.5 * normal - 4 * along, 100);
  // 200 mm/s, faster than any limit of the proxy's own.
  for (int n = 1; n <= 40; ++n) {
    const Vec3 tip = -0.5 * normal + (0.2 * n - 4) * along;
    const Vec3 force = algorithm.step(standing(tip, normal), kTick_s).wrench.force_N;
    EXPECT_NEAR(force.dot(normal), 1.0, 0.01);
    EXPECT_LT(std::abs(force.dot(along)), 0.02) << n;
  }
}

// Lowers bone under the tip's proxy bit by bit, as milling does: the proxy goes down with the surface.
TEST(LineProxy, TheProxyFollowsMilledBoneDown) {
  Volume bone = shape_volume(centred_cube(40, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  LineProxy algorithm = prepared(bone);
  const Vec3 tip(0, 0, -1.5);
  push(algorithm, standing({0, 0, 1}, {0, 0, 1}), tip, 100);
  double surface_mm = 0;
  double force_before_N = 3.0;
  for (int n = 0; n < 400; ++n) {
    surface_mm -= 0.0025;
    const auto milled = shape_volume(bone.geometry(), plane(Vec3(0, 0, surface_mm), Vec3::UnitZ()));
    if (n % 20 == 19) {  // every 0.05 mm
      for (int k = 0; k < 40; ++k) {
        for (int j = 0; j < 40; ++j) {
          for (int i = 0; i < 40; ++i) bone.lower_density({i, j, k}, milled.grid()[{i, j, k}]);
        }
      }
      algorithm.volume_changed({bone.geometry().all_voxels()});
    }
    const HapticStep step = algorithm.step(standing(tip, {0, 0, 1}), kTick_s);
    EXPECT_LE(step.burr_force_W_N.norm(), force_before_N + 1e-4);
    EXPECT_GE(step.burr_force_W_N.norm(), force_before_N - 0.15);
    force_before_N = step.burr_force_W_N.norm();
  }
  // The proxy has yet to follow the last 0.05 mm.
  HapticStep settled;
  for (int n = 0; n < 5; ++n) settled = algorithm.step(standing(tip, {0, 0, 1}), kTick_s);
  EXPECT_NEAR(-settled.burr_force_W_N.z(), 2.0 * (1.5 - 1.0), 0.01);
}

// A block whose upper edge runs along y through (0, y, 4). The shaft leans away from it upwards, so that it
// touches the edge only, from the side.
Volume block_with_edge() {
  return shape_volume(centred_cube(64, 0.25), [](const Vec3& p) { return std::max(-p.x(), 4.0 - p.z()); });
}
Pose leaning(double tip_x) {
  return standing({tip_x, 0.1, -6.1}, {-0.4, 0, 1});
}
// The tip's x when the shaft just touches the edge, 10.1 mm above the tip.
constexpr double kTouchingTip_x = 0.4 * 10.1;

TEST(LineProxy, ReportsTheShaftIntersectionAtTheEdgeItTouches) {
  const Volume bone = block_with_edge();
  LineProxy algorithm = prepared(bone);
  HapticStep step;
  for (int n = 0; n < 1000 && !step.intersection_W; ++n) {
    step = algorithm.step(leaning(kTouchingTip_x - 0.5 + 0.002 * n), kTick_s);
  }
  ASSERT_TRUE(step.intersection_W);
  EXPECT_NEAR(step.intersection_W->x(), 0.0, 0.2);
  EXPECT_NEAR(step.intersection_W->y(), 0.1, 1e-6);
  EXPECT_NEAR(step.intersection_W->z(), 4.0, 0.35);
}

// Lowers the far half of the shaft flat onto the bone below z = 0.
TEST(LineProxy, ReportsAnIntersectionPointOnlyInContact) {
  const Volume bone =
      shape_volume(centred_cube(64, 0.25), [](const Vec3& p) { return std::max(p.z(), p.x()); });
  LineProxy algorithm = prepared(bone);
  const Pose above = standing({10, 0.1, 1}, {-1, 0, 0});
  EXPECT_FALSE(algorithm.step(above, kTick_s).intersection_W);
  const HapticStep step = push(algorithm, above, {10, 0.1, -0.3}, 300);
  ASSERT_TRUE(step.intersection_W);
  EXPECT_LT(step.intersection_W->x(), 0.2);
  EXPECT_NEAR(step.intersection_W->y(), 0.1, 0.05);
  EXPECT_NEAR(step.intersection_W->z(), 0, 0.05);
}

TEST(LineProxy, ShaftOnAnEdgeGivesTorqueButNoForce) {
  const Volume bone = block_with_edge();
  LineProxy algorithm = prepared(bone);
  const HapticStep step =
      push(algorithm, leaning(kTouchingTip_x - 1), leaning(kTouchingTip_x + 0.5).position_mm, 150);
  // The edge is pushed towards +x, so it pushes the shaft back to -x, above the tip: about -y.
  EXPECT_LT(step.wrench.torque_Nmm.y(), -5.0);
  EXPECT_LT(std::abs(step.wrench.torque_Nmm.x()), 0.05 * step.wrench.torque_Nmm.norm());
  EXPECT_EQ(step.burr_force_W_N, Vec3::Zero());
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
}

TEST(LineProxy, TurningScanAndPosesTogetherTurnsTheWrench) {
  const Quat turn = quaternion_from_rotation_vector({0.4, -0.9, 0.6});
  const auto shape = [](const Vec3& p) { return std::max(-p.x(), 4.0 - p.z()); };
  const Volume bone = shape_volume(centred_cube(64, 0.25), shape);
  GridGeometry turned = centred_cube(64, 0.25);
  turned.origin_mm = turn * turned.origin_mm;
  turned.direction = turn.toRotationMatrix();
  const Volume turned_bone = shape_volume(turned, [&](const Vec3& p) { return shape(turn.conjugate() * p); });
  LineProxy algorithm = prepared(bone);
  LineProxy turned_algorithm = prepared(turned_bone);
  for (int n = 0; n < 600; ++n) {
    const Pose X_WD = leaning(kTouchingTip_x - 0.5 + 0.003 * n);
    const Wrench expected = algorithm.step(X_WD, kTick_s).wrench;
    const Wrench wrench =
        turned_algorithm.step({turn * X_WD.position_mm, turn * X_WD.orientation}, kTick_s).wrench;
    ASSERT_LT((turn * expected.force_N - wrench.force_N).norm(), 0.01) << n;
    ASSERT_LT((turn * expected.torque_Nmm - wrench.torque_Nmm).norm(), 0.1) << n;
  }
}

TEST(LineProxy, OutputIsBitIdenticalAfterReset) {
  const Volume bone = block_with_edge();
  LineProxy once = prepared(bone);
  LineProxy twice = prepared(bone);
  // Starts with other motion, which the reset must forget.
  push(twice, leaning(0), leaning(6).position_mm, 50);
  twice.reset();
  for (int n = 0; n < 600; ++n) {
    const Pose X_WD = standing({3.0 + 0.003 * n, 0.3 * std::sin(0.05 * n), -5.0 + 0.01 * n}, {-0.4, 0.1, 1});
    const HapticStep a = once.step(X_WD, kTick_s);
    const HapticStep b = twice.step(X_WD, kTick_s);
    ASSERT_EQ(a.wrench.force_N, b.wrench.force_N);
    ASSERT_EQ(a.wrench.torque_Nmm, b.wrench.torque_Nmm);
    ASSERT_EQ(a.X_WT.position_mm, b.X_WT.position_mm);
    ASSERT_EQ(a.X_WT.orientation.coeffs(), b.X_WT.orientation.coeffs());
  }
}

// The session starts with the vertices in bone; they move along the edge, so that their densities hardly
// change and eq. 1 divides by almost zero.
TEST(LineProxy, StartInsideBoneGivesALargeTorque) {
  const Volume bone = block_with_edge();
  LineProxy algorithm = prepared(bone);
  double largest_Nmm = 0;
  for (int n = 0; n < 100; ++n) {
    Pose X_WD = leaning(kTouchingTip_x + 0.12 + 0.0004 * n);
    X_WD.position_mm.y() += 0.02 * n;
    const HapticStep step = algorithm.step(X_WD, kTick_s);
    largest_Nmm = std::max(largest_Nmm, step.wrench.torque_Nmm.norm());
    EXPECT_TRUE(is_finite(step.X_WT));
  }
  EXPECT_GT(largest_Nmm, 50.0);
}

TEST(LineProxy, RecoversFromNonFiniteTorqueOnceOutsideBone) {
  const Volume bone = block_with_edge();
  LineProxy algorithm = prepared(bone);
  // At rest deep inside: eq. 1 is zero divided by zero or worse.
  int not_finite = 0;
  for (int n = 0; n < 5; ++n) {
    const HapticStep step = algorithm.step(leaning(kTouchingTip_x + 1.5), kTick_s);
    if (!step.wrench.torque_Nmm.allFinite()) ++not_finite;
    EXPECT_TRUE(is_finite(step.X_WT));
    EXPECT_TRUE(std::isfinite(step.burr_force_W_N.norm()));
  }
  EXPECT_GT(not_finite, 0);
  const HapticStep away = push(algorithm, leaning(kTouchingTip_x + 1.5), leaning(0).position_mm, 50);
  EXPECT_EQ(away.wrench.torque_Nmm, Vec3::Zero());
  const HapticStep back = push(algorithm, leaning(0), leaning(kTouchingTip_x + 0.5).position_mm, 500);
  EXPECT_TRUE(back.wrench.torque_Nmm.allFinite());
  EXPECT_LT(back.wrench.torque_Nmm.y(), -5.0);
}

// Two ticks at the same instant: no time passes, and everything is finite.
TEST(LineProxy, ATickOfNoLengthGivesNumbers) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  LineProxy algorithm = prepared(bone);
  push(algorithm, standing({0, 0, 1}, {0.2, 0, 1}), {0, 0, -0.5}, 100);
  for (int n = 0; n < 5; ++n) {
    const HapticStep step = algorithm.step(standing({0.001 * n, 0, -0.5}, {0.2, 0, 1}), 0);
    EXPECT_NEAR(step.wrench.force_N.z(), 1.0, 0.01);
    EXPECT_TRUE(step.wrench.torque_Nmm.allFinite());
    EXPECT_TRUE(is_finite(step.X_WT));
  }
}

// Along a grid line, onto a pole on that line.
TEST(LineProxy, ForceOnTopOfABallIsStiffnessTimesDepth) {
  const Volume bone = shape_volume(centred_cube(49, 0.25), ball(Vec3::Zero(), 5.0));
  LineProxy algorithm = prepared(bone);
  for (const double depth_mm : {0.2, 0.5, 1.0}) {
    const HapticStep step = push(algorithm, standing({0, 0, 6}, Vec3::UnitZ()), {0, 0, 5 - depth_mm}, 200);
    EXPECT_NEAR(step.wrench.force_N.z(), 2 * depth_mm, 0.03) << depth_mm;
    EXPECT_EQ(step.contacts, 1);
  }
}

}  // namespace
}  // namespace osteomill::line_proxy
