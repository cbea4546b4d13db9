#include "bone_points/surface_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "bone_points/bone_bricks.h"
#include "tests/shapes.h"
#include "tests/support/every_point.h"

namespace osteomill {
namespace {

struct BallFigures {
  double area_mm2 = 0;
  double worst_off_mm = 0;
  int points = 0;
};

BallFigures figures(const BrickPoints& points, BoneBricks& bricks, double radius_mm) {
  BallFigures f;
  const SurfaceLattice& lattice = bricks.lattice();
  for_each_point(bricks, points, [&](const ShellPoint& point, const Vec3& origin_G) {
    const Vec3 point_W = lattice.origin_W() + lattice.direction() * (origin_G + point.position_mm());
    f.area_mm2 += static_cast<double>(point.area_mm2);
    f.worst_off_mm = std::max(f.worst_off_mm, std::abs(point_W.norm() - radius_mm));
    ++f.points;
  });
  return f;
}

// At every resolution there are about as many points; they lie on the ball, and their areas add up to its
// area.
TEST(SurfaceLattice, PointsCoverABallAtAnyVoxelSize) {
  constexpr double kRadius_mm = 3;
  const double area_mm2 = 4 * std::numbers::pi * kRadius_mm * kRadius_mm;
  for (const double voxel_mm : {0.05, 0.125, 0.25, 0.5}) {
    const Volume volume =
        testing_support::shape_volume(testing_support::centred_cube(static_cast<int>(8 / voxel_mm), voxel_mm),
                                      testing_support::ball({0.01, 0.02, 0.03}, kRadius_mm), 4);
    BoneBricks bricks(volume, 0.13);
    const BallFigures fine = figures(bricks.fine(), bricks, kRadius_mm);
    const BallFigures coarse = figures(bricks.coarse(), bricks, kRadius_mm);
    EXPECT_NEAR(fine.area_mm2, area_mm2, 0.02 * area_mm2) << voxel_mm;
    EXPECT_NEAR(coarse.area_mm2, area_mm2, 0.02 * area_mm2) << voxel_mm;
    EXPECT_LT(fine.worst_off_mm, 0.04 + 0.1 * voxel_mm) << voxel_mm;
    EXPECT_GT(fine.points, 5000) << voxel_mm;
    EXPECT_LT(fine.points, 20000) << voxel_mm;
    EXPECT_LT(coarse.points, fine.points / 2) << voxel_mm;
    EXPECT_EQ(bricks.dropped(), 0u);
  }
}

double area_of(BoneBricks& bricks) {
  double area_mm2 = 0;
  for_each_point(bricks, [&](const Vec3&, double area) { area_mm2 += area; });
  return area_mm2;
}

// Otherwise the cost of a tick would grow with the square of a scan's resolution.
TEST(SurfaceLattice, FinerScansHaveAtMostAQuarterMorePoints) {
  constexpr double kRadius_mm = 1.5;
  std::size_t coarse_points = 0;
  for (const double voxel_mm : {0.125, 0.0625, 0.03125}) {
    const Volume volume =
        testing_support::shape_volume(testing_support::centred_cube(static_cast<int>(4 / voxel_mm), voxel_mm),
                                      testing_support::ball({0.01, 0.02, 0.03}, kRadius_mm));
    BoneBricks bricks(volume, 0.13);
    EXPECT_NEAR(area_of(bricks), 4 * std::numbers::pi * kRadius_mm * kRadius_mm, 0.3) << voxel_mm;
    const std::size_t points = bricks.fine().total();
    if (coarse_points == 0) coarse_points = points;
    EXPECT_LT(4 * points, 5 * coarse_points) << voxel_mm;
  }
}

TEST(SurfaceLattice, PlaneAreaIsIndependentOfSlopeAndAnisotropicSpacing) {
  GridGeometry geometry = testing_support::centred_cube(48, 0.2);
  geometry.spacing_mm = {0.2, 0.15, 0.25};
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 1, 1), Vec3(1, 2, -3), Vec3(0.1, 1, 0.3)}) {
    const Vec3 through(0.2, -1, 1);
    const Volume volume =
        testing_support::shape_volume(geometry, testing_support::plane(through, normal), 3.0);
    for (const double spacing_mm : {0.05, 0.13, 0.5}) {
      BoneBricks bricks(volume, spacing_mm);
      double area = 0, worst = 0;
      for_each_point(bricks, [&](const Vec3& position, double share) {
        if ((position - through).norm() > 2) return;  // a disc of radius 2
        area += share;
        worst = std::max(worst, std::abs(normal.normalized().dot(position - through)));
      });
      // The disc's rim cuts through cells.
      EXPECT_NEAR(area / (4 * std::numbers::pi), 1, spacing_mm < 0.2 ? 0.04 : 0.07)
          << normal.transpose() << ", " << spacing_mm;
      EXPECT_LT(worst, 0.004);
    }
  }
}

// A rod of bone no wider than the point spacing is found from all sides, at any position and slope.
TEST(SurfaceLattice, FindsARodThinnerThanThePointSpacing) {
  for (const double voxel_mm : {0.031, 0.0195}) {
    for (const Vec3& along : {Vec3(0, 0, 1), Vec3(1, 2, 3), Vec3(-1, 0.1, 0.05)}) {
      for (const double aside_mm : {0.0, 0.02, 0.05}) {
        const Vec3 axis = along.normalized(), through = aside_mm * Vec3(1, 0.7, -0.4);
        const auto rod = [&](const Vec3& p) { return (p - through).cross(axis).norm() - 0.06; };
        const Volume volume = testing_support::shape_volume(
            testing_support::centred_cube(static_cast<int>(1.5 / voxel_mm), voxel_mm), rod);
        BoneBricks bricks(volume, 0.13);
        // In the middle, in sections long enough to contain the mean of at least one cell.
        std::array<int, 4> seen{};
        for_each_point(bricks, [&](const Vec3& position, double) {
          const double at = axis.dot(position - through) / 0.22 + 2;
          if (at >= 0 && at < 4) ++seen[static_cast<std::size_t>(at)];
        });
        for (const int points : seen) EXPECT_GT(points, 0) << voxel_mm << ", " << along.transpose();
      }
    }
  }
}

// Only densities at the scan's border are copied before they are sampled.
TEST(SurfaceLattice, PointsNearTheBorderMatchThoseInALargerGrid) {
  for (const double voxel_mm : {0.125, 0.0625, 0.031}) {
    const auto slope = testing_support::plane({0.03, 0.1, -0.04}, {0.2, 0.1, 1});
    GridGeometry geometry = testing_support::centred_cube(64, voxel_mm);
    const Volume small = testing_support::shape_volume(geometry, slope);
    geometry.dims = {128, 128, 128};
    geometry.origin_mm -= Vec3::Constant(32 * voxel_mm);
    const Volume large = testing_support::shape_volume(geometry, slope);
    const double inside_mm = 26 * voxel_mm;
    const auto points_inside = [&](const Volume& volume) {
      BoneBricks bricks(volume, 0.13);
      std::vector<Vec3> points;
      for_each_point(bricks, [&](const Vec3& p, double) {
        if (p.cwiseAbs().maxCoeff() < inside_mm) points.push_back(p);
      });
      std::sort(points.begin(), points.end(), [](const Vec3& a, const Vec3& b) {
        return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
      });
      return points;
    };
    const std::vector<Vec3> of_small = points_inside(small), of_large = points_inside(large);
    EXPECT_GT(of_small.size(), 100u);
    ASSERT_EQ(of_small.size(), of_large.size()) << voxel_mm;
    double worst = 0;
    for (const Vec3& p : of_small) {
      double nearest = 1;
      for (const Vec3& q : of_large) nearest = std::min(nearest, (p - q).norm());
      worst = std::max(worst, nearest);
    }
    EXPECT_LT(worst, 1e-5) << voxel_mm;
  }
}

// A block of bone that fills the grid has a surface at the border, and one cut by a plane also at the plane.
TEST(SurfaceLattice, BoneHasASurfaceAtTheGridBorder) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(21, 0.1),
                                                      testing_support::plane({0, 0, 0.45}, {0, 0, 1}));
  BoneBricks bricks(volume, 0.13);
  // Two faces of 2.05 mm and four of 2.05 by 1.5, each edge rounded over a voxel.
  EXPECT_NEAR(area_of(bricks), 2 * 2.05 * 2.05 + 4 * 2.05 * 1.5, 1.2);
}

}  // namespace
}  // namespace osteomill
