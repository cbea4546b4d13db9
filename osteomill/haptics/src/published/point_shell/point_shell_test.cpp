#include "published/point_shell/point_shell.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/random.h"
#include "tests/shapes.h"

namespace osteomill::point_shell {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::random_vector;
using testing_support::shape_volume;

const MillingTool kTool{1.5, 1.0, 25.0};
constexpr double kTick_s = 1e-3;

// Returns settings with the coupling that the expected values assume.
Settings full_resolution() {
  Settings settings;
  settings.scale = 1;
  settings.translational_stiffness_N_per_mm = 2;
  settings.torsional_stiffness_Nmm_per_rad = 1000;
  return settings;
}

bool same_bits(const HapticStep& a, const HapticStep& b) {
  const auto same = [](const Vec3& p, const Vec3& q) {
    return std::memcmp(p.data(), q.data(), sizeof(double) * 3) == 0;
  };
  return same(a.wrench.force_N, b.wrench.force_N) && same(a.wrench.torque_Nmm, b.wrench.torque_Nmm) &&
         same(a.X_WT.position_mm, b.X_WT.position_mm) && a.contacts == b.contacts &&
         same(a.burr_force_W_N, b.burr_force_W_N);
}

TEST(PointShell, ToolMatchesDeviceAndWrenchIsZeroInFreeSpace) {
  const Volume volume = shape_volume(centred_cube(40, 0.2), ball({0, 0, 0}, 2.5));
  PointShell algorithm(full_resolution());
  algorithm.prepare({&volume, kTool});
  for (int n = 0; n < 400; ++n) {
    const Pose X_WD{Vec3(0.02 * n - 4, 0.3, 4.3), quaternion_from_rotation_vector({0.001 * n, 0.2, 0})};
    const HapticStep step = algorithm.step(X_WD, kTick_s);
    EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
    EXPECT_EQ(step.wrench.torque_Nmm, Vec3::Zero());
    EXPECT_EQ(step.X_WT.position_mm, X_WD.position_mm);
    EXPECT_EQ(step.X_WT.orientation.coeffs(), X_WD.orientation.coeffs());
    EXPECT_EQ(step.contacts, 0);
    EXPECT_EQ(step.burr_force_W_N, Vec3::Zero());
  }
}

// The shaft alone on the edge of a wall at the lever arm L: the torque is that of the force about the burr's
// centre.
TEST(PointShell, ShaftOnAnEdgeGivesForceAndTorqueOfForceTimesLever) {
  const auto edge = [](const Vec3& p) { return std::max(p.x(), p.z()); };  // bone where x < 0 and z < 0
  const Volume volume = shape_volume(centred_cube(60, 0.15), edge);
  PointShell algorithm(full_resolution());
  algorithm.prepare({&volume, kTool});
  constexpr double kLever = 12.0;
  HapticStep step;
  // The burr hangs free at x = 12; from there the shaft runs back over the edge and rises.
  const Quat along = smallest_rotation(Vec3::UnitZ(), -Vec3::UnitX());
  const Quat tilted = quaternion_from_rotation_vector({0, 0.25, 0}) * along;
  const Vec3 shaft = tilted * Vec3::UnitZ();
  ASSERT_GT(shaft.z(), 0);  // rises from the edge, so that only the edge touches
  for (int n = 0; n <= 600; ++n) {
    const double lift = 1.2 - 0.0025 * n;
    const Vec3 across = Vec3::UnitY().cross(shaft);
    const Vec3 up = across.z() > 0 ? across : Vec3(-across);
    step = algorithm.step({-kLever * shaft + lift * up, tilted}, kTick_s);
  }
  ASSERT_GT(step.contacts, 0);
  EXPECT_EQ(step.burr_force_W_N, Vec3::Zero());
  const double force = step.wrench.force_N.norm();
  EXPECT_GT(force, 0.2);
  EXPECT_GT(step.wrench.force_N.z(), 0.5 * force);
  const Vec3 arm = kLever * shaft_direction(step.X_WT);
  const Vec3 expected = arm.cross(step.wrench.force_N);
  EXPECT_LT((step.wrench.torque_Nmm - expected).norm(), 0.02 * expected.norm());
}

TEST(PointShell, TurningScanAndPosesTogetherTurnsTheWrench) {
  const Pose turn{{3, -1, 2}, quaternion_from_rotation_vector({0.5, -0.8, 1.1})};
  GridGeometry geometry = centred_cube(48, 0.2);
  const auto shape = [](const Vec3& p) {
    return std::max((p - Vec3(0, 0, -1)).norm() - 3.5, 0.3 * p.x() - 0.6);
  };
  const Volume volume = shape_volume(geometry, shape);
  GridGeometry turned = geometry;
  turned.direction = turn.orientation.toRotationMatrix();
  turned.origin_mm = turn * geometry.origin_mm;
  const Volume turned_volume(DensityGrid(turned, every_nth_density(volume.grid(), 1)), volume.isovalue());
  PointShell straight(full_resolution()), rotated(full_resolution());
  straight.prepare({&volume, kTool});
  rotated.prepare({&turned_volume, kTool});
  double max = 0;
  for (int n = 0; n < 300; ++n) {
    const Pose X_WD{{0.8, 0.004 * n - 0.6, 4.3 - 0.004 * n},
                    quaternion_from_rotation_vector({0.2, 0.001 * n, 0})};
    const HapticStep here = straight.step(X_WD, kTick_s);
    const HapticStep there = rotated.step(turn * X_WD, kTick_s);
    EXPECT_LT((there.wrench.force_N - turn.orientation * here.wrench.force_N).norm(), 1e-4);
    EXPECT_LT((there.wrench.torque_Nmm - turn.orientation * here.wrench.torque_Nmm).norm(), 1e-3);
    max = std::max(max, here.wrench.force_N.norm());
  }
  EXPECT_GT(max, 0.5);
}

std::vector<HapticStep> run_with_milling(const Settings& settings) {
  Volume volume = shape_volume(centred_cube(50, 0.2), ball({0, 0, -1}, 3.5));
  PointShell algorithm(settings);
  algorithm.prepare({&volume, kTool});
  std::mt19937 bits(3);
  std::vector<HapticStep> steps;
  for (int n = 0; n < 400; ++n) {
    const Pose X_WD{{0.002 * n, 0.1, 4.2 - 0.003 * n}, quaternion_from_rotation_vector({0.002 * n, 0, 0.1})};
    steps.push_back(algorithm.step(X_WD, kTick_s));
    VolumeChange change;
    for (int m = 0; m < 20; ++m) {
      const Vec3 near = steps.back().X_WT.position_mm + 1.6 * random_vector(bits).normalized();
      const Vec3 voxel = volume.geometry().voxel_from_world(near);
      const VoxelIndex v{static_cast<int>(voxel.x()), static_cast<int>(voxel.y()),
                         static_cast<int>(voxel.z())};
      if (!volume.grid().contains(v)) continue;
      volume.lower_density(v, 0.9f * volume.grid()[v]);
      change.voxels.include(v);
    }
    algorithm.volume_changed(change);
  }
  return steps;
}

TEST(PointShell, OutputIsBitIdenticalForTheSameInput) {
  const auto first = run_with_milling(full_resolution());
  const auto second = run_with_milling(full_resolution());
  int touching = 0;
  for (std::size_t n = 0; n < first.size(); ++n) {
    EXPECT_TRUE(same_bits(first[n], second[n])) << n;
    touching += first[n].contacts > 0 ? 1 : 0;
  }
  EXPECT_GT(touching, 100);
}

TEST(PointShell, ResetForgetsTheContact) {
  const Volume volume = shape_volume(centred_cube(40, 0.2), plane({0, 0, 0}, {0, 0, 1}));
  PointShell algorithm(full_resolution());
  algorithm.prepare({&volume, kTool});
  for (int n = 0; n < 100; ++n) algorithm.step({{0, 0, 2 - 0.01 * n}, Quat::Identity()}, kTick_s);
  algorithm.reset();
  const Pose far{{0, 0, 30}, Quat::Identity()};
  const HapticStep step = algorithm.step(far, kTick_s);
  EXPECT_EQ(step.X_WT.position_mm, far.position_mm);
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
}

TEST(ContactStiffness, PeakForceIsOneAndAHalfTimesTheForceLimit) {
  // The penalty's peak on a plane, at d = 2r/3.
  EXPECT_NEAR(contact_stiffness_N_per_mm3(kTool) * std::numbers::pi * (1.5 - 1.0) * 1.0, 1.5 * 20, 1e-9);
}

}  // namespace
}  // namespace osteomill::point_shell
