#include "barrier_shell/barrier_shell.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/haptics/milling_tool.h"

#include "tests/random.h"
#include "tests/shapes.h"

namespace osteomill::barrier_shell {
namespace {

using testing_support::random_vector;
using testing_support::uniform;

constexpr double kTick_s = 1e-3;

// Moves the device in steps of 0.02 mm, then waits; returns the last step.
HapticStep approach(BarrierShell& algorithm, const Vec3& from, const Vec3& to, const Quat& orientation) {
  const int ticks = std::max(1, static_cast<int>((to - from).norm() / 0.02));
  for (int n = 0; n < ticks; ++n) {
    algorithm.step({from + (n / double(ticks)) * (to - from), orientation}, kTick_s);
  }
  HapticStep step;
  for (int n = 0; n < 50; ++n) step = algorithm.step({to, orientation}, kTick_s);
  return step;
}

TEST(BarrierShell, InFreeSpaceTheWrenchIsExactlyZero) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                                      testing_support::ball(Vec3::Zero(), 3));
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, {}});
  for (int n = 0; n < 2000; ++n) {
    const double angle = 0.01 * n;
    const Pose X_WD{{6 * std::cos(angle), 6 * std::sin(angle), 1.0},
                    quaternion_from_rotation_vector({0.1 * std::sin(angle), 0, angle})};
    const HapticStep step = algorithm.step(X_WD, kTick_s);
    ASSERT_EQ(step.wrench.force_N, Vec3::Zero()) << n;
    ASSERT_EQ(step.wrench.torque_Nmm, Vec3::Zero()) << n;
    ASSERT_EQ(step.X_WT.position_mm, X_WD.position_mm);
  }
}

TEST(BarrierShell, OnAPlaneTheForceIsAlongTheNormal) {
  const Vec3 normal = Vec3(0.3, -0.4, 0.8).normalized();
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2),
                                                      testing_support::plane(Vec3::Zero(), normal));
  const MillingTool tool;
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, tool});
  constexpr double kDepth_mm = 0.8;
  const HapticStep step = approach(algorithm, 3 * normal, (tool.burr_radius_mm - kDepth_mm) * normal,
                                   smallest_rotation(Vec3::UnitZ(), normal));
  const double along_N = step.wrench.force_N.dot(normal);
  // The coupling's spring yields, and the skin extends slightly beyond the tool.
  EXPECT_GT(along_N, 0.85 * 2 * kDepth_mm);
  EXPECT_LT(along_N, 1.1 * 2 * kDepth_mm);
  EXPECT_LT((step.wrench.force_N - along_N * normal).norm(), 0.003 * along_N);
  // The forces of bone and hand balance.
  EXPECT_LT((step.burr_force_W_N + along_N * normal).norm(), 0.01 * along_N);
  EXPECT_EQ(algorithm.counts().energy_rises, 0u);
}

// Returns the pressure integrated over a ball's lower half in a bowl of its own shape, along its axis, with
// its centre `down_mm` below the bowl's.
double bowl_force_N(double radius_mm, double rounding_mm, const Barrier& skin, double down_mm) {
  constexpr int kRings = 2000;
  double force_N = 0;
  for (int n = 0; n < kRings; ++n) {
    const double cosine = (n + 0.5) / kRings;
    force_N += 2 * std::numbers::pi * radius_mm * radius_mm / kRings * cosine *
               skin.at(rounding_mm - down_mm * cosine).pressure;
  }
  return force_N;
}

TEST(BarrierShell, BurrOfAnySizeRestsAtTheCentreOfItsOwnHole) {
  for (const double radius_mm : {0.5, 1.0, 1.5, 3.0}) {
    const MillingTool tool{radius_mm, 0.7 * radius_mm, 25};
    const auto plate = testing_support::plane(Vec3::Zero(), Vec3::UnitZ());
    const auto ball = testing_support::ball(Vec3::Zero(), radius_mm);
    const Volume volume = testing_support::shape_volume(
        testing_support::centred_cube(96, radius_mm / 30),
        [&](const Vec3& point_W) { return std::max(plate(point_W), -ball(point_W)); });
    const Settings settings;
    BarrierShell algorithm{settings};
    algorithm.prepare({&volume, tool});
    const HapticStep step = approach(algorithm, {0, 0, 2 * radius_mm}, {0, 0, -1.5 / 2}, Quat::Identity());
    const double down_mm = -step.X_WT.position_mm.z();
    EXPECT_NEAR(down_mm, 0, 0.03) << radius_mm;
    // Compares with the integrated pressure.
    const double rounding_mm = core_inset_mm(tool, settings.rounding_mm);
    const Barrier skin{settings.skin_width_mm * rounding_mm / settings.rounding_mm,
                       settings.pressure_N_per_mm2 * 1.5 * 1.5 / (radius_mm * radius_mm)};
    EXPECT_NEAR(-step.burr_force_W_N.z(), bowl_force_N(radius_mm, rounding_mm, skin, down_mm), 0.1)
        << radius_mm;
  }
}

double angle_deg(const Vec3& a, const Vec3& b) {
  return 180 / std::numbers::pi * std::atan2(a.cross(b).norm(), a.dot(b));
}

TEST(BarrierShell, ForceFollowsTheNormalWhenSlidingAroundABall) {
  constexpr double kBall_mm = 5, kDepth_mm = 0.5;
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(56, 0.25),
                                                      testing_support::ball(Vec3::Zero(), kBall_mm));
  const MillingTool tool;
  Settings soft;
  soft.translational_stiffness_N_per_mm = 1;
  BarrierShell algorithm{soft};
  algorithm.prepare({&volume, tool});
  const double radius = kBall_mm + tool.burr_radius_mm - kDepth_mm;
  const auto out_at = [](double angle) { return Vec3(std::sin(angle), 0, std::cos(angle)); };
  double angle = -0.6, largest_step_N = 0;
  Vec3 before = approach(algorithm, (radius + 1.5) * out_at(angle), radius * out_at(angle), Quat::Identity())
                    .wrench.force_N;
  std::vector<double> off_deg;
  for (; angle < 0.6; angle += 0.016 / radius) {
    const Vec3 force = algorithm.step({radius * out_at(angle), Quat::Identity()}, kTick_s).wrench.force_N;
    off_deg.push_back(angle_deg(force, out_at(angle)));
    largest_step_N = std::max(largest_step_N, (force - before).norm());
    before = force;
  }
  std::sort(off_deg.begin(), off_deg.end());
  EXPECT_LT(off_deg[off_deg.size() / 2], 0.1);
  EXPECT_LT(off_deg[off_deg.size() * 99 / 100], 0.5);
  EXPECT_LT(largest_step_N, 0.002);
}

TEST(BarrierShell, ShaftOnAnEdgeGivesTorqueOfForceTimesLever) {
  const Quat turn = quaternion_from_rotation_vector({0.3, 0.5, -0.4});
  const Vec3 left = turn * Vec3(1, 0, 1).normalized(), right = turn * Vec3(-1, 0, 1).normalized();
  const Volume volume =
      testing_support::shape_volume(testing_support::centred_cube(64, 0.2),
                                    [&](const Vec3& p) { return std::max(left.dot(p), right.dot(p)); });
  for (const double lever_mm : {4.0, 12.0, 20.0}) {
    BarrierShell algorithm{Settings{}};
    algorithm.prepare({&volume, {}});
    const Quat lying = turn * quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
    const HapticStep step =
        approach(algorithm, turn * Vec3(-lever_mm, 0, 2), turn * Vec3(-lever_mm, 0, 0.7), lying);
    const Vec3 expected = (turn * Vec3(lever_mm, 0, 0)).cross(step.wrench.force_N);
    EXPECT_GT(step.wrench.force_N.norm(), 0.05) << lever_mm;
    EXPECT_LT((step.wrench.torque_Nmm - expected).norm(), 0.01 * expected.norm()) << lever_mm;
  }
}

// Returns the points at which the density crosses the isovalue between two voxels, independently of the
// algorithm.
std::vector<Vec3> surface_points(const Volume& volume) {
  std::vector<Vec3> points;
  const auto& dims = volume.geometry().dims;
  const auto add = [&](const VoxelIndex& a, const VoxelIndex& b) {
    if (!volume.grid().contains(b) || volume.is_bone(a) == volume.is_bone(b)) return;
    const double here = static_cast<double>(volume.grid()[a]), there = static_cast<double>(volume.grid()[b]);
    const double share = (volume.isovalue() - here) / (there - here);
    points.push_back((1 - share) * volume.geometry().world_from_voxel(a) +
                     share * volume.geometry().world_from_voxel(b));
  };
  for (int k = 0; k < dims[2]; ++k) {
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) {
        add({i, j, k}, {i + 1, j, k});
        add({i, j, k}, {i, j + 1, k});
        add({i, j, k}, {i, j, k + 1});
      }
    }
  }
  return points;
}

double deepest_mm(const std::vector<Vec3>& surface, const MillingTool& tool, const Pose& X_WT) {
  double nearest = 1e9;
  const Vec3 middle = X_WT * Vec3(0, 0, 0.5 * tool.shaft_length_mm);
  const double around = 0.5 * tool.shaft_length_mm + tool.burr_radius_mm;
  const Pose X_TW = X_WT.inverse();
  for (const Vec3& point : surface) {
    if ((point - middle).squaredNorm() > around * around) continue;
    nearest = std::min(nearest, tool_distance(tool, X_TW * point).distance_mm);
  }
  return -nearest;
}

// Pushes the device on through the bone, at up to 300 mm/s, until the coupling saturates.
double deepest_of_push(BarrierShell& algorithm, const std::vector<Vec3>& surface, const MillingTool& tool,
                       Pose X_WD, const Vec3& direction, double speed_mm_s, double way_mm) {
  algorithm.reset();
  double deepest = -1e9;
  const int moving = static_cast<int>(way_mm / (speed_mm_s * kTick_s));
  for (int n = 0; n < moving + 60; ++n) {
    const HapticStep step = algorithm.step(X_WD, kTick_s);
    if (n < moving) X_WD.position_mm += speed_mm_s * kTick_s * direction;
    if (n % 32 == 0 || n == moving + 59) deepest = std::max(deepest, deepest_mm(surface, tool, step.X_WT));
  }
  return deepest;
}

TEST(BarrierShell, ToolIsNotPushedThroughAThinSheet) {
  const Vec3 normal = Vec3(0.2, 0.5, 0.8).normalized();
  const Volume volume = testing_support::shape_volume(
      testing_support::centred_cube(48, 0.25), [&](const Vec3& p) { return std::abs(normal.dot(p)) - 0.25; });
  const std::vector<Vec3> surface = surface_points(volume);
  const MillingTool tool{1.5, 1.0, 8};
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, tool});
  const Quat upright = smallest_rotation(Vec3::UnitZ(), normal);
  const Quat on_its_side = upright * quaternion_from_rotation_vector({std::numbers::pi / 2, 0, 0});
  const Quat end_first = upright * quaternion_from_rotation_vector({std::numbers::pi - 0.1, 0, 0});
  const Vec3 middle = on_its_side * Vec3(0, 0, 5), end = end_first * Vec3(0, 0, 8);
  struct Attitude {
    Quat orientation;
    Vec3 aim;
  };
  for (const Attitude& attitude :
       {Attitude{upright, Vec3::Zero()}, Attitude{on_its_side, middle}, Attitude{end_first, end}}) {
    for (const double speed_mm_s : {30.0, 300.0}) {
      const Pose from{4 * normal - attitude.aim, attitude.orientation};
      EXPECT_LT(deepest_of_push(algorithm, surface, tool, from, -normal, speed_mm_s, 12), 0.25);
    }
  }
  EXPECT_GT(algorithm.counts().min_distance_share, 0);
}

TEST(BarrierShell, RandomPushesEnterSpongyBoneByLessThan300um) {
  const Volume volume = testing_support::shape_volume(
      testing_support::centred_cube(56, 0.2),
      [](const Vec3& p) {
        const double gyroid = std::sin(1.3 * p.x()) * std::cos(1.3 * p.y()) +
                              std::sin(1.3 * p.y()) * std::cos(1.3 * p.z()) +
                              std::sin(1.3 * p.z()) * std::cos(1.3 * p.x());
        return std::max(0.5 * gyroid, p.norm() - 4.5);
      },
      1.5);
  const std::vector<Vec3> surface = surface_points(volume);
  std::mt19937 bits(5);
  const MillingTool tool;
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, tool});
  for (int n = 0; n < 300; ++n) {
    const Vec3 direction = random_vector(bits).normalized();
    const Quat orientation = quaternion_from_rotation_vector(3 * random_vector(bits));
    // Starts clear of the bone in any orientation.
    const Pose from{-31 * direction + 2 * random_vector(bits), orientation};
    const double speed_mm_s = 160 + 140 * uniform(bits, -1, 1);
    EXPECT_LT(deepest_of_push(algorithm, surface, tool, from, direction, speed_mm_s, 38), 0.3) << n;
  }
  // While the bone does not change, only the device adds energy.
  EXPECT_EQ(algorithm.counts().energy_rises, 0u) << algorithm.counts().worst_rise_Nmm;
  EXPECT_GT(algorithm.counts().min_distance_share, 0);
}

TEST(BarrierShell, ToolStartedInsideBoneMovesFreelyOutAndIsThenHeld) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2),
                                                      testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, {}});
  double largest_step_N = 0;
  Vec3 before = Vec3::Zero();
  for (int n = 0; n < 800; ++n) {
    const double z = -3 + 0.01 * n;
    const HapticStep step = algorithm.step({{0, 0, z}, Quat::Identity()}, kTick_s);
    if (z < 0) {
      EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
      EXPECT_EQ(step.X_WT.position_mm.z(), z);
    }
    largest_step_N = std::max(largest_step_N, (step.wrench.force_N - before).norm());
    before = step.wrench.force_N;
  }
  EXPECT_LT(largest_step_N, 0.1);
  const HapticStep held = approach(algorithm, {0, 0, 5}, {0, 0, -1}, Quat::Identity());
  EXPECT_GT(held.wrench.force_N.z(), 4);
  EXPECT_GT(held.X_WT.position_mm.z(), 1.3);
}

// Another algorithm left the tool slightly in the bone; the device is far inside.
TEST(BarrierShell, TakeoverInsideBoneHoldsTheToolAndRampsTheWrench) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2),
                                                      testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  for (const double overlap_mm : {0.0, 0.3, 1.0}) {
    BarrierShell algorithm{Settings{}};
    algorithm.prepare({&volume, {}});
    algorithm.step({{0, 0, 1.5 - overlap_mm}, Quat::Identity()}, 0);
    Vec3 before = Vec3::Zero();
    HapticStep step;
    double lowest = 10;
    for (int n = 0; n < 1000; ++n) {
      step = algorithm.step({{0, 0, -3}, Quat::Identity()}, kTick_s);
      EXPECT_LT((step.wrench.force_N - before).norm(), 0.15) << n;
      before = step.wrench.force_N;
      lowest = std::min(lowest, step.X_WT.position_mm.z());
    }
    EXPECT_GT(step.wrench.force_N.z(), 8);
    EXPECT_GT(step.X_WT.position_mm.z(), 1.3) << overlap_mm;
    EXPECT_GT(lowest, 1.25 - overlap_mm);
  }
}

TEST(BarrierShell, ZeroLengthTickReleasesNoForceAndStaysFinite) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2),
                                                      testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, {}});
  const Pose X_WD{{0, 0, 0.5}, quaternion_from_rotation_vector({0.3, 0, 0})};
  const Vec3 held_N = approach(algorithm, {0, 0, 5}, X_WD.position_mm, X_WD.orientation).wrench.force_N;
  EXPECT_GT(held_N.z(), 1);
  EXPECT_LT((algorithm.step(X_WD, 0).wrench.force_N - held_N).norm(), 1e-3);
  // Jumps far beyond what a tick may release, and rotates.
  algorithm.step({{3, 0, 4}, Quat::Identity()}, 0);
  for (int n = 0; n < 3; ++n) {
    const HapticStep still = algorithm.step({{3, 0, 4}, Quat::Identity()}, 0);
    EXPECT_TRUE(still.wrench.force_N.allFinite() && still.wrench.torque_Nmm.allFinite());
    EXPECT_TRUE(still.X_WT.position_mm.allFinite());
  }
  HapticStep step;
  for (int n = 0; n < 1000; ++n) step = algorithm.step({{3, 0, 4}, Quat::Identity()}, kTick_s);
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
}

TEST(BarrierShell, DeviceJumpAcrossBoneHoldsTheToolAndRampsTheWrench) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.2),
                                                      testing_support::ball(Vec3::Zero(), 4));
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, {}});
  Vec3 before = approach(algorithm, {0, 0, 8}, {0, 0, 5}, Quat::Identity()).wrench.force_N;
  EXPECT_GT(before.z(), 0.5);
  for (int n = 0; n < 600; ++n) {
    const HapticStep step = algorithm.step({{0, 0, -45}, Quat::Identity()}, kTick_s);
    EXPECT_LT((step.wrench.force_N - before).norm(), 0.3) << n;
    // Milling must not yet use the full force, which the hand does not feel.
    if (n < 50) {
      EXPECT_LT(step.burr_force_W_N.norm(), step.wrench.force_N.norm() + 0.3) << n;
    }
    before = step.wrench.force_N;
    ASSERT_GT(distance_to_ball({1.3, 0.8, 25}, -step.X_WT.position_mm).distance_mm, 0);
    // Held on this side or guided around it; never inside.
    EXPECT_GT(step.X_WT.position_mm.norm(), 5.2);
  }
}

TEST(BarrierShell, WrenchIsBitIdenticalForTheSameInputAndAfterReset) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(40, 0.25),
                                                      testing_support::ball(Vec3::Zero(), 3));
  const auto run = [](BarrierShell& algorithm) {
    std::vector<double> felt;
    for (int n = 0; n < 600; ++n) {
      const double angle = 0.004 * n;
      const HapticStep step = algorithm.step({{4 * std::sin(angle), 0.2, 6 - 0.004 * n + std::cos(angle) - 1},
                                              quaternion_from_rotation_vector({0.2 * angle, 0.4 * angle, 0})},
                                             kTick_s);
      for (const double number : step.wrench.force_N) felt.push_back(number);
      for (const double number : step.wrench.torque_Nmm) felt.push_back(number);
    }
    return felt;
  };
  BarrierShell one{Settings{}}, other{Settings{}};
  one.prepare({&volume, {}});
  other.prepare({&volume, {}});
  const std::vector<double> first = run(one);
  EXPECT_EQ(first, run(other));
  one.reset();
  EXPECT_EQ(first, run(one));
}

// Removes bone at random under a pressed burr, in islands too: the burr never drops suddenly, and follows.
TEST(BarrierShell, PressedBurrIsNeverReleasedWhileBoneIsMilled) {
  Volume volume = testing_support::shape_volume(testing_support::centred_cube(60, 0.1),
                                                testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const MillingTool tool;
  BarrierShell algorithm{Settings{}};
  algorithm.prepare({&volume, tool});
  std::mt19937 bits(9);
  Vec3 before = approach(algorithm, {0, 0, 3}, {0, 0, 0.5}, Quat::Identity()).wrench.force_N;
  double largest_step_N = 0;
  for (int n = 0; n < 3000; ++n) {
    const HapticStep step = algorithm.step({{0, 0, 0.5 - 5e-4 * n}, Quat::Identity()}, kTick_s);
    ASSERT_GT(step.wrench.force_N.z(), 1.0) << n;
    largest_step_N = std::max(largest_step_N, (step.wrench.force_N - before).norm());
    before = step.wrench.force_N;
    VolumeChange change;
    for (int m = 0; m < 400; ++m) {
      const Vec3 at = step.X_WT.position_mm + 1.7 * random_vector(bits);
      const Vec3 v = volume.geometry().voxel_from_world(at);
      const VoxelIndex voxel{static_cast<int>(std::lround(v.x())), static_cast<int>(std::lround(v.y())),
                             static_cast<int>(std::lround(v.z()))};
      if (!volume.grid().contains(voxel)) continue;
      if ((volume.geometry().world_from_voxel(voxel) - step.X_WT.position_mm).norm() > 1.6) continue;
      volume.lower_density(voxel, 0.93f * volume.grid()[voxel]);
      change.voxels.include(voxel);
    }
    algorithm.volume_changed(change);
  }
  EXPECT_LT(largest_step_N, 0.3);
  EXPECT_LT(algorithm.counts().worst_rise_Nmm, 0.01);
}

}  // namespace
}  // namespace osteomill::barrier_shell
