#include "osteomill/haptics/point_shell/point_shell_algorithm.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/random.h"
#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill::point_shell {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::random_vector;
using testing_support::shape_volume;

const MillingTool kTool{1.5, 1.0, 25.0};
constexpr double kTick_s = 1e-3;

// And coupled alike in both modes, for which the numbers here are.
Settings full_resolution(Mode mode) {
  Settings settings = Settings::defaults(mode);
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

TEST(PointShellAlgorithm, InFreeSpaceTheToolIsTheDeviceAndTheWrenchExactlyZero) {
  const Volume volume = shape_volume(centred_cube(40, 0.2), ball({0, 0, 0}, 2.5));
  for (const Mode mode : {Mode::paper, Mode::steady}) {
    PointShellAlgorithm algorithm(full_resolution(mode));
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
}

// Pressed into a plane: the coupling's spring and the burr's penalty carry the same force.
TEST(PointShellAlgorithm, PressedIntoAPlaneCouplingAndContactCarryTheSameForce) {
  const Vec3 normal = Vec3(1, 2, 4).normalized();
  const Volume volume = shape_volume(centred_cube(64, 0.125), plane({0, 0, 0}, normal));
  PointShellAlgorithm algorithm(full_resolution(Mode::steady));
  algorithm.prepare({&volume, kTool});
  HapticStep step;
  for (int n = 0; n <= 300; ++n) {
    const double sunk_mm = std::min(1.0, 0.005 * n - 0.2);
    step = algorithm.step({(1.5 - sunk_mm) * normal, smallest_rotation(Vec3::UnitZ(), normal)}, kTick_s);
  }
  // kA pi (r - d) d^2 = k (1 - d), by bisection.
  double shallow = 0, deep = 1;
  for (int n = 0; n < 60; ++n) {
    const double d = 0.5 * (shallow + deep);
    const double contact = algorithm.penalty().stiffness_N_per_mm3 * std::numbers::pi * (1.5 - d) * d * d;
    (contact < 2.0 * (1 - d) ? shallow : deep) = d;
  }
  EXPECT_NEAR(step.wrench.force_N.dot(normal), 2.0 * (1 - shallow), 0.005);
  EXPECT_LT(step.wrench.force_N.cross(normal).norm(), 0.01);
  EXPECT_LT((step.burr_force_W_N + step.wrench.force_N).norm(), 1e-3);
  EXPECT_LT(step.wrench.torque_Nmm.norm(), 1e-6);
  EXPECT_GT(step.contacts, 20);
}

struct Slide {
  double median_deg;
  double p99_deg;
  double max_step_N;
};

Slide slide_round_ball(const Settings& settings, double spacing_mm) {
  constexpr double kRadius = 4.0, kDepth = 0.5;
  const Volume volume = shape_volume(centred_cube(static_cast<int>(10.0 / spacing_mm), spacing_mm),
                                     ball({0.02, 0, 0}, kRadius));
  PointShellAlgorithm algorithm(settings);
  algorithm.prepare({&volume, kTool});
  const Vec3 u = Vec3(1, 2, 3).normalized().unitOrthogonal(), v = Vec3(1, 2, 3).normalized().cross(u);
  const auto direction = [&](double angle) { return Vec3(std::cos(angle) * u + std::sin(angle) * v); };
  const auto step_at = [&](double angle, double depth) {
    const Vec3 out = direction(angle);
    return algorithm.step(
        {Vec3(0.02, 0, 0) + (kRadius + 1.5 - depth) * out, smallest_rotation(Vec3::UnitZ(), out)}, kTick_s);
  };
  for (int n = 0; n <= 100; ++n) step_at(0, 0.006 * n - 0.1);
  std::vector<double> errors;
  Slide slide{};
  Vec3 last = step_at(0, kDepth).wrench.force_N;
  const double turn = 0.016 / (kRadius + 1.0);  // 16 mm/s
  for (double angle = turn; angle < 2 * std::numbers::pi; angle += turn) {
    const Vec3 force = step_at(angle, kDepth).wrench.force_N;
    errors.push_back(std::acos(std::min(1.0, force.normalized().dot(direction(angle)))) * 180 /
                     std::numbers::pi);
    slide.max_step_N = std::max(slide.max_step_N, (force - last).norm());
    last = force;
  }
  std::sort(errors.begin(), errors.end());
  slide.median_deg = errors[errors.size() / 2];
  slide.p99_deg = errors[errors.size() * 99 / 100];
  return slide;
}

TEST(PointShellAlgorithm, SteadySlidesRoundABallWithoutARattle) {
  Settings settings = full_resolution(Mode::steady);
  settings.translational_stiffness_N_per_mm = 1;
  for (const double spacing_mm : {0.125, 0.2}) {
    const Slide slide = slide_round_ball(settings, spacing_mm);
    EXPECT_LE(slide.median_deg, 0.7) << spacing_mm;
    EXPECT_LE(slide.p99_deg, 2.0) << spacing_mm;
    EXPECT_LE(slide.max_step_N, 0.0045) << spacing_mm;
  }
}

// The shaft alone on the edge of a wall at the lever L: the torque is the force's, about the burr's centre.
TEST(PointShellAlgorithm, TheShaftOnAnEdgePushesAndTurnsTheHand) {
  const auto edge = [](const Vec3& p) { return std::max(p.x(), p.z()); };  // bone where x < 0 and z < 0
  const Volume volume = shape_volume(centred_cube(60, 0.15), edge);
  for (const Mode mode : {Mode::paper, Mode::steady}) {
    PointShellAlgorithm algorithm(full_resolution(mode));
    algorithm.prepare({&volume, kTool});
    constexpr double kLever = 12.0;
    HapticStep step;
    // The burr hangs free at x = 12; from there the shaft runs back over the edge, and rises.
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
}

TEST(PointShellAlgorithm, SteadyTurnsTheHandByLeverTimesForceWhereverTheEdgeIs) {
  std::mt19937 bits(6);
  for (const double lever_mm : {4.0, 8.0, 12.0, 20.0}) {
    for (int n = 0; n < 3; ++n) {
      const Quat turn = quaternion_from_rotation_vector(3 * random_vector(bits));
      const Vec3 left = turn * Vec3(1, 0, 1).normalized();
      const Vec3 right = turn * Vec3(-1, 0, 1).normalized();
      const Volume volume = shape_volume(centred_cube(56, 0.2),
                                         [&](const Vec3& p) { return std::max(left.dot(p), right.dot(p)); });
      PointShellAlgorithm algorithm(full_resolution(Mode::steady));
      algorithm.prepare({&volume, kTool});
      const Quat lying = turn * quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
      HapticStep step;
      for (int m = 0; m <= 200; ++m) {
        const double height_mm = std::max(0.7, 1.5 - 0.01 * m);
        step = algorithm.step({turn * Vec3(-lever_mm, 0, height_mm), lying}, kTick_s);
      }
      EXPECT_GT(step.wrench.force_N.dot(turn * Vec3::UnitZ()), 0.1);
      const Vec3 expected = (turn * Vec3(lever_mm, 0, 0)).cross(step.wrench.force_N);
      EXPECT_LT((step.wrench.torque_Nmm - expected).norm(), 0.02 * expected.norm()) << lever_mm;
    }
  }
}

// Begun in the middle of a ball of bone, the tool must come out with the device, at any speed and however it
// stands, and nothing may be felt beyond what holds a tool out of bone.
TEST(PointShellAlgorithm, AToolThatBeginsInsideBoneComesOutWithTheDevice) {
  const Volume volume = shape_volume(centred_cube(64, 0.25), ball({0, 0, 0}, 6));
  std::mt19937 bits(8);
  for (const double speed_mm_s : {10.0, 100.0, 1000.0}) {
    for (int n = 0; n < 4; ++n) {
      PointShellAlgorithm algorithm(full_resolution(Mode::steady));
      algorithm.prepare({&volume, kTool});
      const Vec3 out = random_vector(bits).normalized();
      const Quat turn = quaternion_from_rotation_vector(3 * random_vector(bits));
      HapticStep step;
      for (int m = 0; m < 20; ++m) step = algorithm.step({Vec3(0.5, 0.2, 0), turn}, kTick_s);
      EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
      const double far_mm = 40;
      const int ticks = static_cast<int>(far_mm / (speed_mm_s * kTick_s));
      for (int m = 0; m < ticks + 500; ++m) {
        const double gone_mm = std::min(far_mm, m * speed_mm_s * kTick_s);
        step = algorithm.step({Vec3(0.5, 0.2, 0) + gone_mm * out, turn}, kTick_s);
        ASSERT_TRUE(step.wrench.force_N.allFinite() && step.wrench.torque_Nmm.allFinite());
        if (speed_mm_s < 200) {
          ASSERT_LT(step.wrench.force_N.norm(), 20);
        }
      }
      EXPECT_EQ(step.X_WT.position_mm, Vec3(Vec3(0.5, 0.2, 0) + far_mm * out));
      EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
    }
  }
}

// The end face is flat: a vertex of the centreline lies in it, and bone behind it.
TEST(PointShellAlgorithm, TheShaftsEndPressesAsHardAsTheBurr) {
  const Volume volume = shape_volume(centred_cube(40, 0.25), plane({0, 0, 0}, {0, 0, 1}));
  PointShellAlgorithm algorithm(full_resolution(Mode::steady));
  algorithm.prepare({&volume, kTool});
  const Quat end_down = smallest_rotation(Vec3::UnitZ(), -Vec3::UnitZ());
  HapticStep step;
  for (int n = 0; n <= 300; ++n) {
    step = algorithm.step({{0, 0, 25 + std::max(-1.0, 1 - 0.01 * n)}, end_down}, kTick_s);
  }
  EXPECT_GT(step.wrench.force_N.z(), 1.8);  // of 2 N/mm, 1 mm deep
}

// Bone that stays inside the burr, as where milling has left a splinter, must not let go of a tool that came
// from outside.
TEST(PointShellAlgorithm, ASplinterInsideTheBurrDoesNotLetGo) {
  const auto splinter = [](const Vec3& p) {
    return std::max(Vec3(p.x(), p.y(), 0).norm() - 0.3, std::abs(p.z() - 0.8) - 0.6);
  };
  const Volume volume =
      shape_volume(centred_cube(48, 0.2), [&](const Vec3& p) { return std::min(p.z(), splinter(p)); });
  PointShellAlgorithm algorithm(full_resolution(Mode::steady));
  algorithm.prepare({&volume, kTool});
  HapticStep step;
  for (int n = 0; n <= 600; ++n) {
    step = algorithm.step({{0, 0, std::max(-1.5, 4.5 - 0.01 * n)}, Quat::Identity()}, kTick_s);
    if (n > 450) {
      EXPECT_GT(step.wrench.force_N.z(), 0.5) << n;
    }
  }
  EXPECT_GT(step.X_WT.position_mm.z(), 0);
}

// A shelf of bone is gone from one tick to the next.
TEST(PointShellAlgorithm, WhereBoneGivesWayTheWrenchFadesAtASpeed) {
  for (const double tick_s : {0.5e-3, 1e-3, 2e-3}) {
    Volume volume = shape_volume(centred_cube(40, 0.25), plane({0, 0, 0}, {0, 0, 1}));
    const Settings settings = full_resolution(Mode::steady);
    PointShellAlgorithm algorithm(settings);
    algorithm.prepare({&volume, kTool});
    Vec3 before;
    const auto step_at = [&](double z) {
      return algorithm.step({{0, 0, z}, Quat::Identity()}, tick_s).wrench.force_N;
    };
    for (int n = 0; n < 300; ++n) before = step_at(std::max(0.7, 1.6 - 0.005 * n));
    EXPECT_GT(before.norm(), 1.2);
    VolumeChange all;
    for (int k = 0; k < 40; ++k) {
      for (int j = 0; j < 40; ++j) {
        for (int i = 0; i < 40; ++i) {
          volume.lower_density({i, j, k}, volume.grid().outside_density());
          all.voxels.include({i, j, k});
        }
      }
    }
    algorithm.volume_changed(all);
    int ticks = 0;
    for (; before.norm() > 0 && ticks < 10000; ++ticks) {
      const Vec3 now = step_at(0.7);
      constexpr double kRelease_mm_s = 15;
      const double at_a_speed = settings.translational_stiffness_N_per_mm * kRelease_mm_s;
      EXPECT_LE((now - before).norm(), (at_a_speed + before.norm() / 0.1) * tick_s + 1e-9);
      before = now;
    }
    EXPECT_LT(ticks * tick_s, 0.1);
  }
}

TEST(PointShellAlgorithm, TurningScanAndPosesTogetherTurnsTheWrench) {
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
  PointShellAlgorithm straight(full_resolution(Mode::steady)), rotated(full_resolution(Mode::steady));
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
  PointShellAlgorithm algorithm(settings);
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

TEST(PointShellAlgorithm, TheSameInputGivesTheSameBits) {
  for (const Mode mode : {Mode::paper, Mode::steady}) {
    const auto first = run_with_milling(full_resolution(mode));
    const auto second = run_with_milling(full_resolution(mode));
    int touching = 0;
    for (std::size_t n = 0; n < first.size(); ++n) {
      EXPECT_TRUE(same_bits(first[n], second[n])) << n;
      touching += first[n].contacts > 0 ? 1 : 0;
    }
    EXPECT_GT(touching, 100);
  }
}

// A device that runs far ahead: the tool follows it no faster than its limits and stays on its side of the
// bone.
TEST(PointShellAlgorithm, TheToolIsNotPulledThroughAWall) {
  const Volume volume =
      shape_volume(centred_cube(60, 0.2), [](const Vec3& p) { return std::abs(p.z()) - 0.8; });
  PointShellAlgorithm algorithm(full_resolution(Mode::steady));
  algorithm.prepare({&volume, kTool});
  Vec3 last(0.1, 0.2, 4);
  for (int n = 0; n < 400; ++n) {
    const double z = std::max(4 - 0.3 * n, -5.0);  // 300 mm/s, to 14 N of coupling
    const HapticStep step = algorithm.step({{0.1, 0.2, z}, Quat::Identity()}, kTick_s);
    EXPECT_LE((step.X_WT.position_mm - last).norm(), 0.5 + 1e-12);
    EXPECT_GT(step.X_WT.position_mm.z(), 0.8 + 1.5 - 0.3);
    last = step.X_WT.position_mm;
  }
  EXPECT_EQ(algorithm.step({{0.1, 0.2, 4}, Quat::Identity()}, kTick_s).X_WT.position_mm.z() > 2.3, true);
}

TEST(PointShellAlgorithm, ResetForgetsTheContact) {
  const Volume volume = shape_volume(centred_cube(40, 0.2), plane({0, 0, 0}, {0, 0, 1}));
  PointShellAlgorithm algorithm(full_resolution(Mode::steady));
  algorithm.prepare({&volume, kTool});
  for (int n = 0; n < 100; ++n) algorithm.step({{0, 0, 2 - 0.01 * n}, Quat::Identity()}, kTick_s);
  algorithm.reset();
  const Pose far{{0, 0, 30}, Quat::Identity()};
  const HapticStep step = algorithm.step(far, kTick_s);
  EXPECT_EQ(step.X_WT.position_mm, far.position_mm);
  EXPECT_EQ(step.wrench.force_N, Vec3::Zero());
}

TEST(Settings, TheContactStiffnessFollowsFromTheTwoRules) {
  const Settings paper = Settings::defaults(Mode::paper);
  const double kA = contact_stiffness_N_per_mm3(paper, kTool);
  // The penalty's peak on a plane, at d = 2r/3, is half as much again as the greatest force.
  EXPECT_NEAR(kA * std::numbers::pi * (1.5 - 1.0) * 1.0, 1.5 * 20, 1e-9);
  const Settings steady = Settings::defaults(Mode::steady);
  const double d = steady.max_depth_mm;
  EXPECT_NEAR(contact_stiffness_N_per_mm3(steady, kTool) * std::numbers::pi * (1.5 - d) * d * d, 20, 1e-9);
}

}  // namespace
}  // namespace osteomill::point_shell
