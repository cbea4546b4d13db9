#include "published/point_shell/voxel_shell.h"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

#include "tests/random.h"
#include "tests/shapes.h"
#include "tests/support/every_point.h"

namespace osteomill::point_shell {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;
using testing_support::uniform;

struct WorldPoint {
  Vec3 position;
  double area;
};

std::vector<WorldPoint> points_of(const VoxelShell& shell) {
  std::vector<WorldPoint> points;
  for_each_point(shell, [&](const Vec3& position, double area) { points.push_back({position, area}); });
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
  if (!volume.is_bone_in_grid(v)) return false;
  for (int n = 0; n < 6; ++n) {
    const int side = n % 2 == 0 ? -1 : 1;
    const VoxelIndex next{v.i + (n / 2 == 0 ? side : 0), v.j + (n / 2 == 1 ? side : 0),
                          v.k + (n / 2 == 2 ? side : 0)};
    if (!volume.is_bone_in_grid(next)) return true;
  }
  return false;
}

TEST(VoxelShell, PointsAreTheCentresOfTheSurfaceVoxels) {
  const GridGeometry geometry = oblique_geometry();
  const Volume volume =
      shape_volume(geometry, ball(geometry.world_from_voxel(Vec3(18, 20, 8)), 3.5));  // cut by the border
  const std::vector<WorldPoint> points = points_of(VoxelShell(volume, 1));
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

TEST(VoxelShell, CoarseShellMatchesThatOfTheResampledGrid) {
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
  const auto points = points_of(VoxelShell(volume, 3));
  const auto expected = points_of(VoxelShell(resampled, 1));
  EXPECT_GT(points.size(), 200u);
  ASSERT_EQ(points.size(), expected.size());
  for (std::size_t n = 0; n < points.size(); ++n) {
    EXPECT_LT((points[n].position - expected[n].position).norm(), 1e-5);
    EXPECT_NEAR(points[n].area, 0.36, 1e-6);
  }
}

TEST(VoxelShell, EvenScalePutsPointsBetweenVoxels) {
  const Volume volume = shape_volume(centred_cube(32, 0.25), plane({0, 0, 0.6}, {0, 0, 1}));
  for (const WorldPoint& point : points_of(VoxelShell(volume, 2))) {
    const Vec3 voxel = volume.geometry().voxel_from_world(point.position);
    EXPECT_NEAR(voxel.x() - std::floor(voxel.x()), 0.5, 1e-5);
  }
}

// Lowers densities at random, slightly or to zero, in boxes the size of a burr's.
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

void expect_same_points(const VoxelShell& kept, const VoxelShell& rebuilt) {
  ASSERT_EQ(kept.points().total(), rebuilt.points().total());
  const auto kept_points = points_of(kept);
  const auto rebuilt_points = points_of(rebuilt);
  ASSERT_EQ(kept_points.size(), rebuilt_points.size());
  for (std::size_t n = 0; n < kept_points.size(); ++n) {
    EXPECT_EQ(kept_points[n].position, rebuilt_points[n].position);
    EXPECT_EQ(kept_points[n].area, rebuilt_points[n].area);
  }
}

TEST(VoxelShell, RefreshedShellEqualsARebuiltOne) {
  for (const int scale : {1, 2, 3}) {
    const GridGeometry geometry = oblique_geometry();
    Volume volume = shape_volume(geometry, ball(geometry.world_from_voxel(Vec3(18, 20, 12)), 3.4));
    VoxelShell shell(volume, scale);
    std::mt19937 bits(11);
    for (int n = 0; n < 40; ++n) {
      VoxelBox changed;
      mill_at_random(volume, bits, changed);
      shell.refresh(changed);
      if (n % 10 == 9) expect_same_points(shell, VoxelShell(volume, scale));
    }
    EXPECT_EQ(shell.points().dropped(), 0u);
  }
}

TEST(VoxelShell, HasNoPointsInAirAndOnlyBorderPointsInSolidBone) {
  GridGeometry geometry = centred_cube(9, 0.5);
  const Volume air(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 0.f)), 500);
  const Volume bone(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 900.f)), 500);
  EXPECT_EQ(VoxelShell(air, 1).points().total(), 0u);
  EXPECT_EQ(VoxelShell(bone, 1).points().total(), 9u * 9 * 9 - 7 * 7 * 7);
}

}  // namespace
}  // namespace osteomill::point_shell
