#include "osteomill/volume/structure_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

double to_the_cubes_mm(const std::vector<VoxelIndex>& voxels, const GridGeometry& scan, const Vec3& point_W) {
  const Vec3 point = scan.voxel_from_world(point_W);
  double least_mm = std::numeric_limits<double>::infinity();
  for (const VoxelIndex& v : voxels) {
    const Vec3 outside = ((point - Vec3(v.i, v.j, v.k)).cwiseAbs().array() - 0.5).cwiseMax(0);
    least_mm = std::min(least_mm, outside.cwiseProduct(scan.spacing_mm).norm());
  }
  return least_mm;
}

TEST(StructureDistance, MatchesBruteForceWithinHalfAVoxel) {
  GridGeometry scan;
  scan.dims = {70, 60, 40};
  scan.spacing_mm = {0.3, 0.3, 0.5};
  scan.origin_mm = {-4, 3, 11};
  scan.direction = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  // Curved nerve, two voxels thick.
  VoxelSet nerve(VoxelBox{{15, 10, 10}, {55, 50, 32}});
  std::vector<VoxelIndex> voxels;
  for (double t = 0; t < 1; t += 0.002) {
    const VoxelIndex v{20 + static_cast<int>(30 * t), 30 + static_cast<int>(15 * std::sin(6 * t)),
                       12 + static_cast<int>(18 * t * t)};
    for (const VoxelIndex& one : {v, VoxelIndex{v.i, v.j + 1, v.k}}) {
      if (!nerve.contains(one)) voxels.push_back(one);
      nerve.insert(one);
    }
  }
  const StructureDistance distance(nerve, scan);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(-0.2, 1.2);
  double worst_mm = 0;
  for (int n = 0; n < 10000; ++n) {
    const Vec3 point_W =
        scan.world_from_voxel(Vec3(70 * share(random), 60 * share(random), 40 * share(random)));
    const double expected_mm = to_the_cubes_mm(voxels, scan, point_W);
    worst_mm = std::max(worst_mm, std::abs(distance.from(point_W) - expected_mm));
  }
  EXPECT_LT(worst_mm, 0.15);
}

TEST(StructureDistance, IsContinuousAndWithinItsMaxExcess) {
  GridGeometry scan;
  scan.dims = {40, 40, 40};
  scan.spacing_mm = {0.3, 0.3, 0.5};
  scan.direction = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  VoxelSet grains(VoxelBox{{12, 12, 12}, {28, 28, 28}});
  std::vector<VoxelIndex> voxels;
  for (int n = 0; n < 60; ++n) {
    const VoxelIndex v{12 + static_cast<int>(17 * share(random)), 12 + static_cast<int>(17 * share(random)),
                       12 + static_cast<int>(17 * share(random))};
    if (!grains.contains(v)) voxels.push_back(v);
    grains.insert(v);
  }
  const StructureDistance distance(grains, scan);
  for (int n = 0; n < 10000; ++n) {
    const Vec3 point_W =
        scan.world_from_voxel(Vec3(39 * share(random), 39 * share(random), 39 * share(random)));
    const DistanceAndGradient slope = distance.distance_and_gradient_from(point_W);
    const double true_mm = to_the_cubes_mm(voxels, scan, point_W);
    if (true_mm > 0) {
      ASSERT_LE(slope.distance_mm, true_mm + distance.max_excess_mm(true_mm) + 1e-5);
    }
    const Vec3 beside_W = point_W + 1e-4 * Vec3(share(random), share(random), share(random));
    ASSERT_NEAR(distance.distance_and_gradient_from(beside_W).distance_mm, slope.distance_mm, 3e-4);
    const double rise_mm = distance.distance_and_gradient_from(point_W + 1e-7 * slope.gradient_W).distance_mm;
    ASSERT_NEAR((rise_mm - slope.distance_mm) / 1e-7, slope.gradient_W.squaredNorm(), 1e-3);
  }
}

TEST(StructureDistance, GradientFromSolidsMatchesFiniteDifferences) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> share(-4, 4);
  for (const StructureDistance& solid :
       {StructureDistance(SphereShape{{0.5, 0, 0}, 2}), StructureDistance(BoxShape{{-1, -2, -1}, {1, 1, 2}}),
        StructureDistance(CylinderShape{{0, 0, -1}, {1, 1, 2}, 1})}) {
    for (int n = 0; n < 1000; ++n) {
      const Vec3 point_W(share(random), share(random), share(random));
      const DistanceAndGradient slope = solid.distance_and_gradient_from(point_W);
      ASSERT_NEAR(slope.distance_mm, solid.from(point_W), 1e-9);
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 step = 1e-6 * Vec3::Unit(axis);
        ASSERT_NEAR(slope.gradient_W[axis], (solid.from(point_W + step) - solid.from(point_W - step)) / 2e-6,
                    1e-3);
      }
    }
  }
}

TEST(StructureDistance, MeasuresSolidsExactly) {
  const StructureDistance sphere(SphereShape{{1, 2, 3}, 2});
  EXPECT_DOUBLE_EQ(sphere.from({6, 2, 3}), 3);
  EXPECT_DOUBLE_EQ(sphere.from({1, 3, 3}), 0);
  const StructureDistance box(BoxShape{{0, 0, 0}, {1, 2, 3}});
  EXPECT_DOUBLE_EQ(box.from({4, 6, 3}), 5);
  EXPECT_DOUBLE_EQ(box.from({0.5, 1, 1}), 0);
  const StructureDistance cylinder(CylinderShape{{0, 0, 0}, {0, 0, 4}, 1});
  EXPECT_DOUBLE_EQ(cylinder.from({0, 3, 2}), 2);
  EXPECT_DOUBLE_EQ(cylinder.from({0, 4, 8}), 5);
  EXPECT_DOUBLE_EQ(cylinder.from({0, 0.5, -2}), 2);
  EXPECT_THROW(StructureDistance(VoxelSet(), GridGeometry()), std::invalid_argument);
}

TEST(NoGoDistances, ReturnNearestDistanceMinusBurrRadius) {
  const NoGoDistances structures{{StructureDistance(SphereShape{{0, 0, 0}, 1})},
                                 {StructureDistance(BoxShape{{5, -1, -1}, {6, 1, 1}})}};
  EXPECT_DOUBLE_EQ(no_go_distance_mm(structures, {3.5, 0, 0}, 0.5), 1);
  EXPECT_DOUBLE_EQ(no_go_distance_mm(structures, {1.25, 0, 0}, 0.5), -0.25);
  EXPECT_TRUE(std::isnan(no_go_distance_mm({}, {0, 0, 0}, 0.5)));
  EXPECT_TRUE(std::isnan(no_go_distance_mm(structures, {NAN, 0, 0}, 0.5)));
}

}  // namespace
}  // namespace osteomill
