#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/surface_points/surface_points.h"

namespace osteomill::surface_points {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

constexpr double kDt = 1e-3;
const MillingTool kTool{1.5, 1.0, 25.0};

Settings steady() {
  return Settings::defaults(Mode::steady);
}

SurfacePoints prepared(const Volume& volume, const Settings& settings) {
  SurfacePoints algorithm(settings);
  algorithm.prepare({&volume, kTool});
  return algorithm;
}

// The last of steps that go from `from` to `to` in moves of 0.05 mm, and wait there.
HapticStep walk(SurfacePoints& algorithm, const Vec3& from, const Vec3& to, const Quat& orientation) {
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from).norm() / 0.05)));
  for (int n = 0; n < steps; ++n) algorithm.step({from + (to - from) * n / steps, orientation}, kDt);
  HapticStep step;
  for (int n = 0; n < 20; ++n) step = algorithm.step({to, orientation}, kDt);
  return step;
}

Volume slope(const Vec3& normal) {
  return shape_volume(centred_cube(64, 0.25), plane(Vec3::Zero(), normal));
}

// A sphere covered evenly with radial springs of k in all, on a plane at depth d: with c0 = (r - d) / r,
// F = k/2 (r (1 - c0^2) / 2 - (r - d) (1 - c0)).
double integral_force_N(double k, double depth_mm) {
  const double r = kTool.burr_radius_mm;
  const double c0 = (r - depth_mm) / r;
  return 0.5 * k * (0.5 * r * (1 - c0 * c0) - (r - depth_mm) * (1 - c0));
}

TEST(SurfacePointsSteady, OnAPlaneTheSpringsForceIsTheIntegralOverTheSphere) {
  const Vec3 normal = Vec3(0.3, 0.2, 1).normalized();
  const Volume volume = slope(normal);
  Settings settings = steady();
  settings.max_stiffness_N_per_mm = 1e9;
  settings.hold_tool = false;
  auto algorithm = prepared(volume, settings);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  for (const double depth : {0.5, 0.7, 1.0, 1.4}) {
    double mean = 0;
    for (int n = 0; n < 20; ++n) {
      const Quat turned = smallest_rotation(Vec3::UnitZ(), normal) *
                          quaternion_from_rotation_vector({unit(random), unit(random), 4 * unit(random)});
      algorithm.reset();
      const HapticStep step = walk(algorithm, 2.0 * normal, (1.5 - depth) * normal, turned);
      const double force = step.wrench.force_N.dot(normal);
      // 24 vertices stand for the sphere: 0.15 of the force one by one, 0.05 on the average.
      EXPECT_NEAR(force, integral_force_N(20, depth), 0.15 * integral_force_N(20, depth)) << depth;
      EXPECT_LT((step.wrench.force_N - force * normal).norm(), 0.2 * force) << depth;
      mean += force / 20;
    }
    EXPECT_NEAR(mean, integral_force_N(20, depth), 0.05 * integral_force_N(20, depth)) << depth;
  }
}

TEST(SurfacePointsSteady, TheContactIsNeverStifferThanAllowed) {
  const Volume volume = slope(Vec3::UnitZ());
  const Settings settings = steady();
  constexpr double kSlowTick_s = 1;  // so slow that the damping does not show
  auto algorithm = prepared(volume, settings);
  double before = 0;
  double min = 1e9;
  for (int n = 0; n < 400; ++n) {
    const double force =
        algorithm.step({{0, 0, 1.6 - 0.01 * n}, Quat::Identity()}, kSlowTick_s).wrench.force_N.z();
    // 24 vertices, not a smooth sphere: half as stiff again where four of them touch at once.
    EXPECT_LT(force - before, 0.01 * 1.5 * settings.max_stiffness_N_per_mm) << n;
    if (n > 60) min = std::min(min, force - before);
    before = force;
  }
  EXPECT_GT(min, 0.005);  // it always pushes back harder, centre inside or not
  EXPECT_GT(before, 5.0);
}

TEST(SurfacePointsSteady, TheShaftsEndIsFelt) {
  const Volume volume = slope(Vec3::UnitZ());
  auto algorithm = prepared(volume, steady());
  const Quat end_down = smallest_rotation(Vec3::UnitZ(), -Vec3::UnitZ());
  const HapticStep step =
      walk(algorithm, {0, 0, kTool.shaft_length_mm + 1}, {0, 0, kTool.shaft_length_mm - 1}, end_down);
  EXPECT_GT(step.wrench.force_N.z(), 0.4);
  EXPECT_LT(step.wrench.torque_Nmm.norm(), 0.03 * kTool.shaft_length_mm * step.wrench.force_N.norm());
}

TEST(SurfacePointsSteady, FreeSpaceIsExactlyZero) {
  const Volume volume = slope(Vec3::UnitZ());
  auto algorithm = prepared(volume, steady());
  for (int n = 0; n < 600; ++n) {
    const double t = 0.01 * n;
    const Pose X{{3 * std::sin(2 * t), 3 * std::cos(t), 2.6 + std::sin(3 * t)},
                 quaternion_from_rotation_vector({0.8 * std::sin(t), 0.8 * std::cos(2 * t), t})};
    const HapticStep step = algorithm.step(X, kDt);
    EXPECT_EQ(step.wrench.force_N, Vec3::Zero()) << n;
    EXPECT_EQ(step.wrench.torque_Nmm, Vec3::Zero()) << n;
    EXPECT_EQ(step.burr_force_W_N, Vec3::Zero()) << n;
    EXPECT_EQ(step.contacts, 0) << n;
  }
}

// A ridge 1.5 mm thick across the shaft, which is pressed 0.3 mm deep onto it at several levers.
TEST(SurfacePointsSteady, TheShaftAloneOnARidgePushesAndTurnsTogether) {
  const Volume volume = shape_volume(centred_cube(64, 0.25),
                                     [](const Vec3& p) { return std::max(std::abs(p.x()) - 0.75, p.z()); });
  const Quat lying = quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
  auto algorithm = prepared(volume, steady());
  for (const double lever : {8.0, 10.3, 12.1, 15.0, 18.6}) {
    algorithm.reset();
    const HapticStep step = walk(algorithm, {-lever, 0, 1.3}, {-lever, 0, 0.7}, lying);
    const Vec3 force = step.wrench.force_N;
    EXPECT_GT(force.z(), 0.01) << lever;
    EXPECT_EQ(step.burr_force_W_N, Vec3::Zero()) << lever;
    const Vec3 expected = Vec3(lever, 0, 0).cross(force);
    EXPECT_LT((step.wrench.torque_Nmm - expected).norm(), 0.02 * expected.norm()) << lever;
    EXPECT_LT(step.wrench.torque_Nmm.y(), 0) << lever;
  }
}

// The shaft alone, 0.3 mm deep on the crest of a square edge that lies anyhow in the grid.
TEST(SurfacePointsSteady, TheShaftOnAnEdgeIsFeltAtItsLever) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(-2, 2);
  for (const double lever : {4.0, 8.0, 12.0, 20.0}) {
    for (int n = 0; n < 3; ++n) {
      const Quat turn = quaternion_from_rotation_vector({unit(random), unit(random), unit(random)});
      const Vec3 left = turn * Vec3(1, 0, 1).normalized();
      const Vec3 right = turn * Vec3(-1, 0, 1).normalized();
      const Volume volume = shape_volume(centred_cube(56, 0.2),
                                         [&](const Vec3& p) { return std::max(left.dot(p), right.dot(p)); });
      auto algorithm = prepared(volume, steady());
      const Quat lying = turn * quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
      const Wrench wrench =
          walk(algorithm, turn * Vec3(-lever, 0, 2), turn * Vec3(-lever, 0, 0.7), lying).wrench;
      EXPECT_GT(wrench.force_N.dot(turn * Vec3::UnitZ()), 0.04) << lever;
      const Vec3 expected = (turn * Vec3(lever, 0, 0)).cross(wrench.force_N);
      EXPECT_LT((wrench.torque_Nmm - expected).norm(), 0.02 * expected.norm()) << lever;
    }
  }
}

TEST(SurfacePointsSteady, TurningScanAndPoseTurnsTheWrench) {
  const Quat turn = quaternion_from_rotation_vector({0.7, -1.1, 0.4});
  GridGeometry turned_grid = centred_cube(64, 0.25);
  turned_grid.direction = turn.toRotationMatrix();
  turned_grid.origin_mm = turn * turned_grid.origin_mm;
  const auto shape = [](const Vec3& p) { return std::min((p - Vec3(1, 0, -3)).norm() - 3.0, p.z() + 1.5); };
  const Volume straight = shape_volume(centred_cube(64, 0.25), shape);
  const Volume turned = shape_volume(turned_grid, [&](const Vec3& p) { return shape(turn.conjugate() * p); });
  auto a = prepared(straight, steady());
  auto b = prepared(turned, steady());
  for (int n = 0; n < 60; ++n) {
    const Pose X{{0.2, 0.1, 2.0 - 0.02 * n}, quaternion_from_rotation_vector({0.2, 0.6, 0})};
    const Wrench one = a.step(X, kDt).wrench;
    const Wrench two = b.step({turn * X.position_mm, turn * X.orientation}, kDt).wrench;
    EXPECT_LT((turn * one.force_N - two.force_N).norm(), 1e-3 + 1e-3 * one.force_N.norm()) << n;
    EXPECT_LT((turn * one.torque_Nmm - two.torque_Nmm).norm(), 1e-2 + 1e-2 * one.torque_Nmm.norm()) << n;
  }
}

TEST(SurfacePointsSteady, SlidingRoundABallHasNoSteps) {
  const Vec3 centre(0, 0, -3);
  const Volume volume = shape_volume(centred_cube(96, 0.125), ball(centre, 5));
  auto algorithm = prepared(volume, steady());
  Vec3 before = Vec3::Zero();
  double largest = 0;
  for (int n = 0; n < 1200; ++n) {
    const double angle = -0.25 + 16.0 * n * kDt / 6.0 * 0.15;
    const Vec3 out(std::sin(angle), 0, std::cos(angle));
    const double depth = std::min(0.5, 0.002 * n);
    const Vec3 force = algorithm.step({centre + (6.5 - depth) * out, Quat::Identity()}, kDt).wrench.force_N;
    if (n > 400) {
      largest = std::max(largest, (force - before).norm());
      EXPECT_GT(force.normalized().dot(out), std::cos(10 * std::numbers::pi / 180));
    }
    before = force;
  }
  EXPECT_GT(before.norm(), 0.2);
  EXPECT_LT(largest, 0.01);
}

// A handle of 0.3 kg in a hand that pulls it along as a spring and damper with a limit to its push; encoder
// steps of 5 um, the force acting 0.3 ms after the pose was read. Translation alone.
struct HandAndHandle {
  double limit_N = 1.5;
  Vec3 position_mm = Vec3::Zero();
  Vec3 velocity_mm_s = Vec3::Zero();
  Vec3 force_before_N = Vec3::Zero();

  Vec3 read() const { return 0.005 * (position_mm / 0.005).array().round().matrix(); }
  void advance(const Vec3& force_N, const Vec3& target_mm, const Vec3& target_mm_s) {
    constexpr int kSubsteps = 20;
    constexpr double kStep_s = kDt / kSubsteps;
    for (int n = 0; n < kSubsteps; ++n) {
      Vec3 hand_N = 0.5 * (target_mm - position_mm);
      if (hand_N.norm() > limit_N) hand_N *= limit_N / hand_N.norm();
      hand_N += 0.005 * (target_mm_s - velocity_mm_s);
      const Vec3 device_N = n < 6 ? force_before_N : force_N;
      velocity_mm_s += kStep_s * 1000 / 0.3 * (hand_N + device_N);
      position_mm += kStep_s * velocity_mm_s;
    }
    force_before_N = force_N;
  }
};

TEST(SurfacePointsSteady, AHandThatPressesIsCalm) {
  const Vec3 normal = Vec3(0.3, 0.2, 1).normalized();
  const Volume volume = slope(normal);
  auto algorithm = prepared(volume, steady());
  const Quat upright = smallest_rotation(Vec3::UnitZ(), normal);
  for (const double push : {1.5, 3.0}) {
    algorithm.reset();
    HandAndHandle handle;
    handle.limit_N = push;
    handle.position_mm = 2.0 * normal;
    const Vec3 target = 2.0 * normal - 20.0 * normal;
    double squares = 0;
    Vec3 slow = Vec3::Zero();
    for (int n = 0; n < 2500; ++n) {
      const HapticStep step = algorithm.step({handle.read(), upright}, kDt);
      slow += 0.1 * (step.wrench.force_N - slow);
      if (n >= 1500) squares += (step.wrench.force_N - slow).squaredNorm();
      handle.advance(step.wrench.force_N, target, Vec3::Zero());
    }
    EXPECT_NEAR(slow.norm(), push, 0.05 * push);
    EXPECT_LT(std::sqrt(squares / 1000), 0.01 * push);
  }
}

// Pushes of 2 to 10 N at 20 to 300 mm/s, from any side and with the tool at any angle, onto a wall 1 mm thick
// and onto one that is thinner than how far the tool sees.
class ThinWall : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(SurfacePointsSteady, ThinWall, ::testing::Values(1.0, 0.15));

TEST_P(ThinWall, NoPushGoesThrough) {
  const double half_mm = 0.5 * GetParam();
  const Volume volume = shape_volume(
      centred_cube(81, 0.25), [=](const Vec3& p) { return std::abs(p.z()) - half_mm; }, 1);
  auto algorithm = prepared(volume, steady());
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int push = 0; push < 40; ++push) {
    algorithm.reset();
    HandAndHandle handle;
    handle.limit_N = 2 + 8 * unit(random);
    const double speed = 20 + 280 * unit(random);
    const Quat tilted = quaternion_from_rotation_vector({unit(random) - 0.5, unit(random) - 0.5, 0});
    const Vec3 way(0.4 * (unit(random) - 0.5), 0.4 * (unit(random) - 0.5), -1);
    const Vec3 start = Vec3(0, 0, 2.3) - 0.5 * Vec3(way.x(), way.y(), 0);
    handle.position_mm = start;
    handle.velocity_mm_s = speed * way;
    HapticStep step;
    for (int n = 0; n < 250; ++n) {
      step = algorithm.step({handle.read(), tilted}, kDt);
      const double pulled = std::min(speed * kDt * n, 25.0);
      handle.advance(step.wrench.force_N, start + pulled * way,
                     pulled < 25 ? Vec3(speed * way) : Vec3::Zero());
      ASSERT_GT(step.X_WT.position_mm.z(), half_mm + 1.5 - 0.3) << push << " tick " << n;
    }
    EXPECT_GT(step.wrench.force_N.z(), 1.0) << push;
  }
}

// All of the bone at once.
TEST(SurfacePointsSteady, WhereBoneGivesWayTheForceFadesAndDoesNotStep) {
  Volume volume = slope(Vec3::UnitZ());
  auto algorithm = prepared(volume, steady());
  const Pose X{{0, 0, 0.9}, Quat::Identity()};
  Vec3 before = walk(algorithm, {0, 0, 2}, X.position_mm, X.orientation).wrench.force_N;
  EXPECT_GT(before.z(), 1.0);
  VolumeChange change;
  const auto [columns, rows, layers] = volume.geometry().dims;
  for (int k = 0; k < layers; ++k) {
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < columns; ++i) volume.lower_density({i, j, k}, volume.grid()[{0, 0, layers - 1}]);
    }
  }
  change.voxels.include({0, 0, 0});
  change.voxels.include({columns - 1, rows - 1, layers - 1});
  algorithm.volume_changed(change);
  double largest = 0;
  for (int n = 0; n < 500; ++n) {
    const Vec3 force = algorithm.step(X, kDt).wrench.force_N;
    largest = std::max(largest, (force - before).norm());
    before = force;
  }
  EXPECT_LT(largest, 0.2);
  EXPECT_EQ(before, Vec3::Zero());
}

TEST(SurfacePointsSteady, NothingIsFeltWhereItStartsInside) {
  const Volume volume = slope(Vec3::UnitZ());
  auto algorithm = prepared(volume, steady());
  const HapticStep step = algorithm.step({{0, 0, -2}, Quat::Identity()}, kDt);
  EXPECT_EQ(step.burr_force_W_N, Vec3::Zero());
  EXPECT_GT(step.contacts, 12);
}

TEST(SurfacePointsSteady, TheSameInputGivesTheSameBits) {
  const Volume volume = shape_volume(centred_cube(64, 0.25), ball({0, 0, -3}, 4));
  auto a = prepared(volume, steady());
  auto b = prepared(volume, steady());
  b.step({{0, 0.3, 0.5}, Quat::Identity()}, kDt);
  b.reset();
  for (int n = 0; n < 200; ++n) {
    const Pose X{{0.01 * n, 0.3, 2.6 - 0.01 * n}, quaternion_from_rotation_vector({0.2, 0.004 * n, 0})};
    const HapticStep one = a.step(X, kDt);
    const HapticStep two = b.step(X, kDt);
    EXPECT_EQ(one.wrench.force_N, two.wrench.force_N);
    EXPECT_EQ(one.wrench.torque_Nmm, two.wrench.torque_Nmm);
  }
}

}  // namespace
}  // namespace osteomill::surface_points
