#include "osteomill/haptics/point_shell/point_shell.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

namespace osteomill::point_shell {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

double uniform(std::mt19937& bits, double from, double to) {
  return from + (to - from) * (static_cast<double>(bits()) / 4294967295.0);
}

ShellRules paper_rules(int scale) {
  ShellRules rules = Settings::defaults(Mode::paper).shell;
  rules.scale = scale;
  return rules;
}

ShellRules steady_rules(int scale) {
  ShellRules rules = Settings::defaults(Mode::steady).shell;
  rules.scale = scale;
  return rules;
}

struct WorldPoint {
  Vec3 position;
  double area;
};

std::vector<WorldPoint> points_of(const PointShell& shell) {
  std::vector<WorldPoint> points;
  shell.for_each_point([&](const Vec3& position, double area) { points.push_back({position, area}); });
  return points;
}

GridGeometry oblique_geometry() {
  GridGeometry geometry;
  geometry.dims = {37, 41, 30};
  geometry.spacing_mm = {0.2, 0.25, 0.3};
  geometry.origin_mm = {5, -3, 8};
  geometry.direction = quaternion_from_rotation_vector({0.4, -0.8, 0.3}).toRotationMatrix();
  geometry.direction.col(2) *= -1;  // left-handed
  return geometry;
}

bool is_surface(const Volume& volume, const VoxelIndex& v) {
  if (!volume.is_bone_or_outside(v)) return false;
  for (int n = 0; n < 6; ++n) {
    const int side = n % 2 == 0 ? -1 : 1;
    const VoxelIndex next{v.i + (n / 2 == 0 ? side : 0), v.j + (n / 2 == 1 ? side : 0),
                          v.k + (n / 2 == 2 ? side : 0)};
    if (!volume.is_bone_or_outside(next)) return true;
  }
  return false;
}

TEST(PointShell, ThePapersPointsAreTheCentresOfTheSurfaceVoxels) {
  const GridGeometry geometry = oblique_geometry();
  const Volume volume =
      shape_volume(geometry, ball(geometry.world_from_voxel(Vec3(18, 20, 8)), 3.5));  // cut by the border
  const std::vector<WorldPoint> points = points_of(PointShell(volume, paper_rules(1)));
  std::size_t expected = 0;
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) expected += is_surface(volume, {i, j, k}) ? 1 : 0;
    }
  }
  EXPECT_GT(expected, 1000u);
  ASSERT_EQ(points.size(), expected);
  std::vector<bool> seen(geometry.voxel_count(), false);
  for (const WorldPoint& point : points) {
    const Vec3 voxel = geometry.voxel_from_world(point.position);
    const VoxelIndex v{static_cast<int>(std::lround(voxel.x())), static_cast<int>(std::lround(voxel.y())),
                       static_cast<int>(std::lround(voxel.z()))};
    EXPECT_LT((voxel - Vec3(v.i, v.j, v.k)).norm(), 1e-5);
    EXPECT_TRUE(is_surface(volume, v));
    EXPECT_FALSE(seen[volume.grid().linear_index(v)]) << "twice";
    seen[volume.grid().linear_index(v)] = true;
    EXPECT_NEAR(point.area, std::pow(0.2 * 0.25 * 0.3, 2.0 / 3.0), 1e-6);
  }
}

TEST(PointShell, ACoarsePaperShellIsTheShellOfTheResampledGrid) {
  const Volume volume = shape_volume(centred_cube(50, 0.2), ball({0.1, 0.2, -0.1}, 3.7));
  GridGeometry coarse = volume.geometry();
  coarse.dims = {17, 17, 17};
  coarse.spacing_mm *= 3;
  coarse.origin_mm = volume.geometry().world_from_voxel(Vec3(1, 1, 1));
  std::vector<float> densities;
  for (int n = 0; n < 17 * 17 * 17; ++n) {
    densities.push_back(static_cast<float>(
        density_at(volume.grid(), coarse.world_from_voxel(VoxelIndex{n % 17, n / 17 % 17, n / (17 * 17)}))));
  }
  const Volume resampled(DensityGrid(coarse, densities), volume.isovalue());
  const auto points = points_of(PointShell(volume, paper_rules(3)));
  const auto expected = points_of(PointShell(resampled, paper_rules(1)));
  EXPECT_GT(points.size(), 200u);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    EXPECT_LT((points[n].position - expected[n].position).norm(), 1e-5);
    EXPECT_NEAR(points[n].area, 0.36, 1e-6);
  }
}

TEST(PointShell, OnAnEvenScaleTheCoarseCentreLiesBetweenVoxels) {
  const Volume volume = shape_volume(centred_cube(32, 0.25), plane({0, 0, 0.6}, {0, 0, 1}));
  for (const WorldPoint& point : points_of(PointShell(volume, paper_rules(2)))) {
    const Vec3 voxel = volume.geometry().voxel_from_world(point.position);
    EXPECT_NEAR(voxel.x() - std::floor(voxel.x()), 0.5, 1e-5);
  }
}

// The area of a ball, whatever the scale, and points on its surface.
TEST(PointShell, SteadyPointsLieOnTheSurfaceAndShareOutItsArea) {
  constexpr double kRadius = 4.0;
  const Volume volume = shape_volume(centred_cube(80, 0.125), ball({0.03, -0.02, 0.05}, kRadius));
  for (const int scale : {1, 2, 3}) {
    double area = 0;
    double worst = 0;
    PointShell(volume, steady_rules(scale)).for_each_point([&](const Vec3& position, double share) {
      area += share;
      worst = std::max(worst, std::abs((position - Vec3(0.03, -0.02, 0.05)).norm() - kRadius));
    });
    EXPECT_NEAR(area / (4 * std::numbers::pi * kRadius * kRadius), 1, 0.015) << scale;
    // The mean of a patch lies below a curved surface by at most (half its diagonal)^2 / (2 radius).
    EXPECT_LT(worst, 0.003 + std::pow(0.87 * scale * 0.125, 2) / (2 * kRadius)) << scale;
  }
}

// So that the cost of a tick does not grow with the square of how fine a scan is.
TEST(PointShell, AFineScanHasLessThanTwiceThePointsOfOneOfASixteenthOfAMillimetre) {
  constexpr double kRadius = 1.5, kCoarse_mm = 0.0625;
  const Volume coarse = shape_volume(centred_cube(56, kCoarse_mm), ball(Vec3::Zero(), kRadius));
  const std::uint32_t points = PointShell(coarse, steady_rules(1)).point_count();
  for (const int finer : {2, 3}) {
    const Volume fine =
        shape_volume(centred_cube(56 * finer, kCoarse_mm / finer), ball(Vec3::Zero(), kRadius));
    const PointShell shell(fine, steady_rules(1));
    EXPECT_LT(shell.point_count(), 2 * points) << finer;
    double area = 0;
    for (const WorldPoint& point : points_of(shell)) area += point.area;
    EXPECT_NEAR(area / (4 * std::numbers::pi * kRadius * kRadius), 1, 0.015) << finer;
  }
}

TEST(PointShell, TheAreaOfAPlaneDoesNotDependOnItsSlopeOrOnUnevenSpacing) {
  GridGeometry geometry = centred_cube(48, 0.2);
  geometry.spacing_mm = {0.2, 0.15, 0.25};
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 1, 1), Vec3(1, 2, -3), Vec3(0.1, 1, 0.3)}) {
    const Vec3 through(0.2, -1, 1);
    const Volume volume = shape_volume(geometry, plane(through, normal), 3.0);
    double area = 0;
    double worst = 0;
    PointShell(volume, steady_rules(1)).for_each_point([&](const Vec3& position, double share) {
      if ((position - through).norm() > 2) return;  // a disc of radius 2
      area += share;
      worst = std::max(worst, std::abs(normal.normalized().dot(position - through)));
    });
    EXPECT_NEAR(area / (4 * std::numbers::pi), 1, 0.04) << normal.transpose();
    EXPECT_LT(worst, 0.004);
  }
}

// The short way for voxels inside the grid and the general way say the same.
TEST(PointShell, APointNearTheBorderIsComputedAsAnyOther) {
  GridGeometry geometry = centred_cube(12, 0.2);
  const Volume small = shape_volume(geometry, plane({0.03, 0.1, -1.04}, {0.2, 0.1, 1}));
  geometry.dims = {24, 24, 24};
  geometry.origin_mm -= Vec3::Constant(1.2);
  const Volume large = shape_volume(geometry, plane({0.03, 0.1, -1.04}, {0.2, 0.1, 1}));
  const auto of_large = points_of(PointShell(large, steady_rules(1)));
  int compared = 0;
  for (const WorldPoint& point : points_of(PointShell(small, steady_rules(1)))) {
    if (point.position.cwiseAbs().maxCoeff() > 0.95) continue;  // its neighbours are cut off
    if (point.position.z() > -1.2) ++compared;
    double nearest = 1;
    for (const WorldPoint& other : of_large) {
      nearest =
          std::min(nearest, (other.position - point.position).norm() + std::abs(other.area - point.area));
    }
    EXPECT_LT(nearest, 1e-5);
  }
  EXPECT_GT(compared, 10);
}

// Lowers densities at random: here a little, there to nothing, in boxes such as a burr's.
void mill_at_random(Volume& volume, std::mt19937& bits, VoxelBox& changed) {
  const auto& dims = volume.geometry().dims;
  VoxelIndex first{static_cast<int>(bits() % static_cast<unsigned>(dims[0])),
                   static_cast<int>(bits() % static_cast<unsigned>(dims[1])),
                   static_cast<int>(bits() % static_cast<unsigned>(dims[2]))};
  const VoxelBox box =
      VoxelBox{first, {first.i + 9, first.j + 6, first.k + 4}}.intersected(volume.geometry().all_voxels());
  for (int n = 0; n < 60; ++n) {
    const VoxelIndex v{first.i + static_cast<int>(bits() % 10), first.j + static_cast<int>(bits() % 7),
                       first.k + static_cast<int>(bits() % 5)};
    if (!box.contains(v)) continue;
    const double left = bits() % 2 == 0 ? 0.0 : uniform(bits, 0.6, 1.0);
    volume.lower_density(v, static_cast<float>(left * static_cast<double>(volume.grid()[v])));
    changed.include(v);
  }
}

void expect_same_points(const PointShell& kept, const PointShell& rebuilt) {
  ASSERT_EQ(kept.point_count(), rebuilt.point_count());
  const auto kept_points = points_of(kept);
  const auto rebuilt_points = points_of(rebuilt);
  ASSERT_EQ(kept_points.size(), rebuilt_points.size());
  for (std::size_t n = 0; n < kept_points.size(); ++n) {
    EXPECT_EQ(kept_points[n].position, rebuilt_points[n].position);
    EXPECT_EQ(kept_points[n].area, rebuilt_points[n].area);
  }
}

void expect_kept_up(const ShellRules& rules) {
  GridGeometry geometry = oblique_geometry();
  Volume volume = shape_volume(geometry, ball(geometry.world_from_voxel(Vec3(18, 20, 12)), 3.4));
  PointShell shell(volume, rules);
  std::mt19937 bits(11);
  for (int n = 0; n < 40; ++n) {
    VoxelBox changed;
    mill_at_random(volume, bits, changed);
    shell.refresh(changed);
    if (n % 10 != 9) continue;
    while (!shell.is_up_to_date()) shell.refresh({});
    expect_same_points(shell, PointShell(volume, rules));
  }
  EXPECT_EQ(shell.points().dropped(), 0u);
}

TEST(PointShell, KeptUpIsTheSameAsRebuilt) {
  for (const int scale : {1, 2, 3}) {
    expect_kept_up(paper_rules(scale));
    ShellRules rules = steady_rules(scale);
    rules.refreshed_points_per_tick = 0;
    expect_kept_up(rules);
  }
}

TEST(PointShell, SpreadOverTicksItIsTheSameInTheEnd) {
  for (const int scale : {1, 2}) {
    for (const int budget : {1, 50, 400}) {
      ShellRules rules = steady_rules(scale);
      rules.refreshed_points_per_tick = budget;
      expect_kept_up(rules);
    }
  }
}

// What fell after a sweep has begun waits for the next one, and may be all gone meanwhile.
TEST(PointShell, PointsThatWaitForTheirTurnAreFinite) {
  GridGeometry geometry = oblique_geometry();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Volume volume = shape_volume(geometry, ball(geometry.world_from_voxel(Vec3(18, 20, 12)), 3.4));
    ShellRules rules = steady_rules(1);
    rules.refreshed_points_per_tick = 50;
    PointShell shell(volume, rules);
    std::mt19937 bits(seed);
    for (int n = 0; n < 40; ++n) {
      VoxelBox changed;
      mill_at_random(volume, bits, changed);
      shell.refresh(changed);
      for (const WorldPoint& point : points_of(shell)) {
        ASSERT_LT(point.position.norm(), 100) << "seed " << seed << ", tick " << n;
        ASSERT_TRUE(std::isfinite(point.area));
      }
    }
  }
}

TEST(PointShell, PointsFollowADensityThatFallsOnlyInPart) {
  Volume volume = shape_volume(centred_cube(24, 0.25), plane({0, 0, 0.1}, {0, 0, 1}));
  for (const bool follow : {true, false}) {
    PointShell shell(volume, follow ? steady_rules(1) : paper_rules(1));
    const auto before = points_of(shell);
    VoxelBox changed;
    for (int n = 0; n < 24 * 24; ++n) {
      const VoxelIndex v{n % 24, n / 24, 11};
      const float lower = 0.9f * volume.grid()[v];
      if (!(static_cast<double>(lower) > volume.isovalue())) continue;
      volume.lower_density(v, lower);
      changed.include(v);
    }
    shell.refresh(changed);
    while (!shell.is_up_to_date()) shell.refresh({});
    const auto after = points_of(shell);
    ASSERT_EQ(before.size(), after.size());
    double moved = 0;
    for (std::size_t n = 0; n < before.size(); ++n) {
      moved = std::max(moved, (after[n].position - before[n].position).norm());
    }
    EXPECT_EQ(moved > 0.001, follow);
  }
}

TEST(PointShell, WithoutBoneThereAreNoPointsAndAllBoneEndsAtTheBorder) {
  GridGeometry geometry = centred_cube(9, 0.5);
  const Volume air(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 0.f)), 500);
  const Volume bone(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 900.f)), 500);
  for (const ShellRules& rules : {paper_rules(1), steady_rules(1)}) {
    EXPECT_EQ(PointShell(air, rules).point_count(), 0u);
    EXPECT_EQ(PointShell(bone, rules).point_count(), 9u * 9 * 9 - 7 * 7 * 7);
  }
}

// A grid of single voxels asks for more points than there is room for only where the pool is too small; then
// points are dropped, counted, and taken in again once there is room.
TEST(BrickPoints, APoolThatRunsOutDropsPointsAndSaysSo) {
  BrickPoints pool(2, 2);
  const std::vector<ShellPoint> many(100, ShellPoint{1, 2, 3, 4});
  EXPECT_EQ(pool.replace(0, many), 64u);
  EXPECT_EQ(pool.dropped(), 36u);
  EXPECT_EQ(pool.replace(1, many), 0u);
  EXPECT_EQ(pool.replace(0, {}), 0u);
  EXPECT_EQ(pool.replace(1, {many.data(), 40}), 40u);
  std::array<ShellPoint, 40> copied;
  pool.copy(1, copied);
  EXPECT_EQ(copied[39], many[0]);
}

}  // namespace
}  // namespace osteomill::point_shell
