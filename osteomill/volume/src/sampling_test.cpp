#include "osteomill/volume/sampling.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

GridGeometry turned_geometry() {
  GridGeometry geometry;
  geometry.dims = {9, 11, 13};
  geometry.spacing_mm = {0.5, 0.25, 1.5};
  geometry.origin_mm = {10, -4, 3};
  geometry.direction = quaternion_from_rotation_vector({0.3, 0.5, -0.9}).toRotationMatrix();
  return geometry;
}

// Density linear in W, for which trilinear sampling and its gradient are exact.
DensityGrid linear_grid(const GridGeometry& geometry, const Vec3& slope) {
  std::vector<float> densities;
  for (int k = 0; k < geometry.dims[2]; ++k)
    for (int j = 0; j < geometry.dims[1]; ++j)
      for (int i = 0; i < geometry.dims[0]; ++i)
        densities.push_back(static_cast<float>(slope.dot(geometry.world_from_voxel(VoxelIndex{i, j, k}))));
  return DensityGrid(geometry, densities);
}

TEST(GridGeometry, WorldAndVoxelTransformsAreInverse) {
  const GridGeometry geometry = turned_geometry();
  const Vec3 voxel(3.25, -2, 17.5);
  EXPECT_LT((geometry.voxel_from_world(geometry.world_from_voxel(voxel)) - voxel).norm(), 1e-12);
}

TEST(Sampling, LinearDensityIsExactOnRotatedAnisotropicGrid) {
  const Vec3 slope(3, -7, 2);
  const DensityGrid grid = linear_grid(turned_geometry(), slope);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 200; ++n) {
    const Vec3 voxel(1 + 6 * unit(random), 1 + 8 * unit(random), 1 + 10 * unit(random));
    const Vec3 point = grid.geometry().world_from_voxel(voxel);
    EXPECT_NEAR(density_at(grid, point), slope.dot(point), 1e-4);
    EXPECT_LT((density_gradient(grid, point) - slope).norm(), 1e-4);
  }
}

TEST(Sampling, ReturnsOutsideDensityBeyondBorder) {
  const DensityGrid grid = linear_grid(turned_geometry(), {1, 1, 1});
  const double outside = static_cast<double>(grid.outside_density());
  for (const Vec3& voxel : {Vec3(-1.5, 3, 3), Vec3(3, 11.0, 3), Vec3(1e300, 0, 0), Vec3(0, 0, -1e18)}) {
    EXPECT_EQ(density_at_voxel(grid, voxel), outside);
  }
  const double border = static_cast<double>(grid[{0, 5, 5}]);
  EXPECT_NEAR(density_at_voxel(grid, {-0.5, 5, 5}), 0.5 * (border + outside), 1e-3);
  EXPECT_EQ(density_gradient(grid, {1e300, 0, 0}), Vec3::Zero());
}

struct AngleError {
  double worst_deg = 0;
  double mean_deg = 0;
};

// Error on an edge two voxels wide, over planes oblique to the axes.
AngleError normal_error() {
  AngleError error;
  int count = 0;
  for (const Vec3& normal : {Vec3(1, 2, 3), Vec3(1, 1, 0), Vec3(-2, 1, 5), Vec3(0.2, 0.1, 1)}) {
    const Vec3 unit = normal.normalized();
    const Volume volume = shape_volume(centred_cube(32, 0.25), plane(Vec3::Zero(), unit));
    for (int n = 0; n < 200; ++n, ++count) {
      Vec3 point = Vec3::Random() * 2.0;
      point -= unit.dot(point) * unit;
      const Vec3 gradient = -density_gradient(volume.grid(), point);
      const double angle_deg =
          std::acos(std::min(1.0, gradient.normalized().dot(unit))) * 180 / std::numbers::pi;
      error.worst_deg = std::max(error.worst_deg, angle_deg);
      error.mean_deg += angle_deg;
    }
  }
  error.mean_deg /= count;
  return error;
}

TEST(Sampling, PlaneNormalIsWithinHalfADegreeOnAverage) {
  const AngleError error = normal_error();
  EXPECT_LT(error.mean_deg, 0.5);
  EXPECT_LT(error.worst_deg, 1.6);
}

}  // namespace
}  // namespace osteomill
