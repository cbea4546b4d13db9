#include "osteomill/milling/burr_mill.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

constexpr BoneDensities kBone{0, 1000};
// A round rate, so that the expected volume is easy to read.
const MillingSettings kMilling{.removal_rate_mm3_per_Ns = 2.0};
constexpr double kRadius_mm = 1.5;

Vec3 down(double force_N) {
  return {0, 0, -force_N};
}

GridGeometry cube_of(double side_mm, double spacing_mm) {
  return centred_cube(static_cast<int>(std::lround(side_mm / spacing_mm)), spacing_mm);
}

// Bone below z = 0 with an edge 0.25 mm wide for any voxel size.
Volume half_space(const GridGeometry& geometry, const Vec3& normal = Vec3::UnitZ()) {
  return shape_volume(geometry, plane(Vec3::Zero(), normal), 0.25 / geometry.spacing_mm.minCoeff());
}

double charge_mm3(const DensityGrid& grid, const BoneDensities& bone) {
  double sum = 0;
  for (const float density : every_nth_density(grid, 1)) {
    sum += std::max(0.0, static_cast<double>(density) - bone.surroundings);
  }
  return sum * grid.geometry().voxel_volume_mm3() / (bone.reference - bone.surroundings);
}

// Returns how far below z = 0 the surface lies on the axis along `down` through the origin.
double hole_depth_mm(const Volume& volume, const Vec3& down) {
  const std::optional<Vec3> surface = first_crossing(volume, -down, 3.5 * down);
  return surface ? surface->dot(down) : 3.5;
}

struct Hole {
  double pressed_mm3 = 0;
  double removed_mm3 = 0;
  double depth_mm = 0;
};

// Presses a burr straight down, at the depth at which a spring of 20 N/mm balances the force.
Hole mill_hole(Volume& volume, BurrMill& mill, double force_N, double seconds, double rate_hz,
               const Vec3& down = -Vec3::UnitZ()) {
  Hole hole;
  const double dt_s = 1 / rate_hz;
  for (int n = 0; n < static_cast<int>(std::lround(seconds * rate_hz)); ++n) {
    const double centre_depth_mm = hole_depth_mm(volume, down) - kRadius_mm + force_N / 20;
    hole.removed_mm3 += mill.step(centre_depth_mm * down, force_N * down, dt_s).removed_mm3;
    hole.pressed_mm3 += kMilling.removal_rate_mm3_per_Ns * force_N * dt_s;
  }
  hole.depth_mm = hole_depth_mm(volume, down);
  return hole;
}

Hole mill_hole_in(const GridGeometry& geometry, double rate_hz, const Vec3& normal = Vec3::UnitZ()) {
  Volume volume = half_space(geometry, normal);
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  return mill_hole(volume, mill, 1.5, 2.5, rate_hz, -normal);
}

TEST(BurrMill, HeldBurrRemovesTheForceBudgetThenStops) {
  for (const double spacing_mm : {0.25, 0.2, 0.125, 0.05}) {
    for (const double radius_mm : {0.5, 1.5}) {
      for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(0.3, -0.4, 0.8), Vec3(0.6, 0.1, 0.5)}) {
        const Vec3 down = -normal.normalized();
        Volume volume = half_space(cube_of(5, spacing_mm), normal.normalized());
        BurrMill mill(volume, radius_mm, kBone, kMilling);
        const Vec3 centre_W = -(radius_mm - 0.05) * down;
        double removed_mm3 = 0, last_cut_s = 0;
        for (int n = 1; n <= 1000; ++n) {
          const double cut_mm3 = mill.step(centre_W, 1.5 * down, 1e-3).removed_mm3;
          if (cut_mm3 > 0) last_cut_s = 1e-3 * n;
          removed_mm3 += cut_mm3;
        }
        EXPECT_LT(last_cut_s, 0.9) << spacing_mm << ' ' << radius_mm << ' ' << normal.transpose();
        // Tolerance: twice the carried-over budget of 10 ms.
        const double paid_mm3_s = kMilling.removal_rate_mm3_per_Ns * 1.5;
        EXPECT_NEAR(removed_mm3, paid_mm3_s * last_cut_s, 0.02 * paid_mm3_s)
            << spacing_mm << ' ' << radius_mm << ' ' << normal.transpose();
      }
    }
  }
}

TEST(BurrMill, RemovedVolumeMatchesTheForceBudget) {
  for (const double force_N : {0.1, 1.5, 6.0}) {
    const GridGeometry geometry = cube_of(7, 0.125);
    Volume volume = half_space(geometry);
    BurrMill mill(volume, kRadius_mm, kBone, kMilling);
    const double before_mm3 = charge_mm3(volume.grid(), kBone);
    const Hole hole = mill_hole(volume, mill, force_N, 3 / force_N, 1000);
    EXPECT_NEAR(hole.removed_mm3 / hole.pressed_mm3, 1, 0.01) << force_N;
    EXPECT_NEAR(before_mm3 - charge_mm3(volume.grid(), kBone), hole.removed_mm3, 1e-9) << force_N;
    EXPECT_GT(hole.depth_mm, 0.8) << force_N;
  }
}

TEST(BurrMill, CutsEnamelSlowerInProportionToItsDensity) {
  const GridGeometry geometry = cube_of(7, 0.125);
  Volume dentine = half_space(geometry);
  std::vector<float> denser = every_nth_density(dentine.grid(), 1);
  for (float& density : denser) density *= 1.9f;
  Volume enamel(DensityGrid(geometry, denser), 1.9 * 500);
  BurrMill dentine_mill(dentine, kRadius_mm, kBone, kMilling);
  BurrMill enamel_mill(enamel, kRadius_mm, kBone, kMilling);
  const Hole in_dentine = mill_hole(dentine, dentine_mill, 1.5, 1.0, 1000);
  const Hole in_enamel = mill_hole(enamel, enamel_mill, 1.5, 1.9, 1000);
  EXPECT_NEAR(in_enamel.removed_mm3, 1.9 * in_dentine.removed_mm3, 0.02 * in_enamel.removed_mm3);
  EXPECT_NEAR(in_enamel.depth_mm, in_dentine.depth_mm, 0.01);
}

bool touches_surface(const Volume& volume, const Vec3& centre) {
  constexpr int kPoints = 2000;
  for (int n = 0; n < kPoints; ++n) {
    const double z = -1 + (n + 0.5) / kPoints;
    const double across = std::sqrt(1 - z * z);
    const Vec3 outwards(across * std::cos(2.399963 * n), across * std::sin(2.399963 * n), z);
    if (density_at(volume.grid(), centre + kRadius_mm * outwards) > volume.isovalue()) return true;
  }
  return false;
}

TEST(BurrMill, NeverStallsOnDenseBoneThatItOnlyTouches) {
  // The burr stays on the surface, like a proxy. The denser the bone, the farther its voxels are behind the
  // isosurface.
  for (const double spacing_mm : {0.125, 0.25}) {
    for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(Vec3::Ones().normalized())}) {
      const Volume bone = half_space(cube_of(6, spacing_mm), normal);
      std::vector<float> densities = every_nth_density(bone.grid(), 1);
      for (float& density : densities) density *= 3;
      Volume volume(DensityGrid(bone.geometry(), densities), 500);
      BurrMill mill(volume, kRadius_mm, kBone, kMilling);
      double removed_mm3 = 0;
      double height_mm = 1.8;
      for (int n = 0; n < 1000; ++n) {
        while (!touches_surface(volume, height_mm * normal)) height_mm -= 0.005;
        removed_mm3 += mill.step(height_mm * normal, -1.5 * normal, 0.001).removed_mm3;
      }
      EXPECT_NEAR(removed_mm3, 3, 0.02 * 3) << spacing_mm;
    }
  }
}

TEST(BurrMill, RemovesNothingWithoutForceContactOrValidInput) {
  const GridGeometry geometry = cube_of(5, 0.25);
  Volume volume = half_space(geometry);
  const CopyOnWriteFloats before = volume.grid().densities();
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Vec3 inside(0, 0, -0.5);
  for (const double force_N : {0.0, nan, infinity}) {
    const MillingStep step = mill.step(inside, {0, 0, -force_N}, 0.001);
    EXPECT_EQ(step.removed_mm3, 0);
    EXPECT_TRUE(step.change.voxels.empty());
  }
  EXPECT_EQ(mill.step(Vec3(nan, 0, 0), down(1), 0.001).removed_mm3, 0);
  EXPECT_EQ(mill.step(Vec3(0, infinity, 0), down(1), 0.001).removed_mm3, 0);
  EXPECT_EQ(mill.step(inside, down(1), 0).removed_mm3, 0);
  EXPECT_EQ(mill.step(Vec3(0, 0, 3), down(1), 0.001).removed_mm3, 0) << "in the air";
  EXPECT_EQ(mill.step(Vec3(1e300, 0, 0), down(1), 0.001).removed_mm3, 0) << "far away";
  EXPECT_EQ(volume.grid().densities(), before);
}

TEST(BurrMill, StopsAtItsReachAndBoundsTheUnspentBudget) {
  constexpr double kSpacing_mm = 0.25, kForce_N = 5;
  const GridGeometry geometry = cube_of(5, kSpacing_mm);
  Volume volume = half_space(geometry);
  const Volume original = volume;
  const BoneDensities bone{391.7, 900};
  BurrMill mill(volume, kRadius_mm, bone, kMilling);
  const double held_mm3 = charge_mm3(volume.grid(), bone);
  const Vec3 centre(0, 0, -0.6);
  double removed_mm3 = 0;
  for (int n = 0; n < 3000; ++n) removed_mm3 += mill.step(centre, down(kForce_N), 0.001).removed_mm3;
  EXPECT_NEAR(held_mm3 - charge_mm3(volume.grid(), bone), removed_mm3, 1e-6);
  // One voxel ahead, and the reach of the cut profile.
  const double outside_mm = kRadius_mm + (1 + 1.55) * kSpacing_mm, inside_mm = kRadius_mm - kSpacing_mm;
  for (int k = 0; k < geometry.dims[2]; ++k)
    for (int j = 0; j < geometry.dims[1]; ++j)
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const double now = static_cast<double>(volume.grid()[{i, j, k}]);
        const double was = static_cast<double>(original.grid()[{i, j, k}]);
        const double distance_mm = (geometry.world_from_voxel(VoxelIndex{i, j, k}) - centre).norm();
        if (distance_mm < inside_mm) {
          EXPECT_NEAR(now, std::min(was, 391.7), 1e-3);
        }
        if (distance_mm > outside_mm) {
          EXPECT_EQ(now, was);
        }
        EXPECT_TRUE(now >= 391.7 || now == was);
      }
  EXPECT_LE(mill.unspent_mm3(), kMilling.removal_rate_mm3_per_Ns * kForce_N * 0.01 * (1 + 1e-12));
  EXPECT_GT(mill.unspent_mm3(), 0);
}

TEST(BurrMill, DropsTheUnspentBudgetOnlyAfterALift) {
  const GridGeometry geometry = cube_of(5, 0.25);
  Volume volume = half_space(geometry);
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  const Vec3 air(0, 0, 3);
  mill.step(air, down(10), 0.001);
  for (int n = 0; n < 40; ++n) mill.step(air, down(0), 0.001);
  EXPECT_NEAR(mill.unspent_mm3(), 0.02, 1e-12) << "40 ms without force are no lift";
  mill.step(air, down(1e-9), 0.001);
  for (int n = 0; n < 51; ++n) mill.step(air, down(0), 0.001);
  EXPECT_EQ(mill.unspent_mm3(), 0);
}

TEST(BurrMill, CutsOnThePressedSideOfAFittingHole) {
  // In a hole that fits it, pressed at an angle: bone is removed on that side only.
  const GridGeometry geometry = cube_of(6, 0.125);
  Volume volume = shape_volume(geometry, [](const Vec3& p) { return kRadius_mm - p.norm(); });
  const Volume before = volume;
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  const Vec3 press = Vec3(0.5, 0.3, -0.8).normalized();
  for (int n = 0; n < 200; ++n) mill.step(Vec3::Zero(), 1.5 * press, 0.001);
  double lost_there = 0, deepest_drop = 0;
  Vec3 deepest = Vec3::Zero();
  for (int k = 0; k < geometry.dims[2]; ++k)
    for (int j = 0; j < geometry.dims[1]; ++j)
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const Vec3 at = geometry.world_from_voxel(VoxelIndex{i, j, k});
        const double drop =
            static_cast<double>(before.grid()[{i, j, k}]) - static_cast<double>(volume.grid()[{i, j, k}]);
        if (at.dot(press) <= 0) {
          ASSERT_NEAR(drop, 0, 60) << "the edge of the hole, rounded off in its voxels";
        } else {
          lost_there += drop;
        }
        if (drop > deepest_drop) {
          deepest_drop = drop;
          deepest = at;
        }
      }
  EXPECT_GT(lost_there, 10 * 60);
  EXPECT_GT(deepest.normalized().dot(press), 0.8);
}

TEST(BurrMill, MakesTheSameHoleAtAnyHapticRate) {
  const Hole at_1000 = mill_hole_in(cube_of(7, 0.125), 1000);
  for (const double rate_hz : {500.0, 2000.0}) {
    const Hole hole = mill_hole_in(cube_of(7, 0.125), rate_hz);
    EXPECT_NEAR(hole.removed_mm3, at_1000.removed_mm3, 0.02 * at_1000.removed_mm3) << rate_hz;
    EXPECT_NEAR(hole.depth_mm, at_1000.depth_mm, 0.02 * at_1000.depth_mm) << rate_hz;
  }
}

TEST(BurrMill, MakesTheSameHoleAtAnyVoxelSize) {
  const Hole finest = mill_hole_in(cube_of(7, 0.10), 1000);
  EXPECT_NEAR(finest.removed_mm3 / finest.pressed_mm3, 1, 0.02);
  for (const double spacing_mm : {0.25, 0.20}) {
    const Hole hole = mill_hole_in(cube_of(7, spacing_mm), 1000);
    EXPECT_NEAR(hole.removed_mm3, finest.removed_mm3, 0.02 * finest.removed_mm3) << spacing_mm;
    EXPECT_NEAR(hole.depth_mm, finest.depth_mm, spacing_mm) << spacing_mm;
  }
}

// With 0.0625 mm voxels the burr overlaps thousands and cuts a share of its lines in each step; with 0.25 mm
// voxels it overlaps a few hundred and cuts all.
TEST(BurrMill, MakesTheSameHoleCuttingAShareOfLinesPerStep) {
  const auto hole_in = [](double spacing_mm) {
    Volume volume = half_space(cube_of(5, spacing_mm));
    BurrMill mill(volume, kRadius_mm, kBone, kMilling);
    const Hole hole = mill_hole(volume, mill, 2, 0.8, 1000);
    // The remaining surface is spherical, without ridges between lines. Compares its depth at points around
    // the axis.
    double min = 1, max = 0;
    for (int n = 0; n < 24; ++n) {
      const double angle = n * 2 * M_PI / 24;
      const Vec3 side(0.4 * std::cos(angle), 0.4 * std::sin(angle), 0);
      const std::optional<Vec3> surface =
          first_crossing(volume, side + Vec3::UnitZ(), side - 2 * Vec3::UnitZ());
      const double depth_mm = surface ? -surface->z() : 2.0;
      min = std::min(min, depth_mm);
      max = std::max(max, depth_mm);
    }
    return std::pair(hole, max - min);
  };
  const auto [coarse, coarse_spread] = hole_in(0.25);
  const auto [fine, fine_spread] = hole_in(0.0625);
  EXPECT_NEAR(fine.removed_mm3 / fine.pressed_mm3, 1, 0.02);
  EXPECT_NEAR(fine.removed_mm3, coarse.removed_mm3, 0.02 * coarse.removed_mm3);
  EXPECT_NEAR(fine.depth_mm, coarse.depth_mm, 0.1);
  EXPECT_LT(fine_spread, 0.5 * 0.0625);
}

TEST(BurrMill, MakesTheSameHoleInAnisotropicVoxels) {
  GridGeometry geometry;
  geometry.dims = {56, 35, 28};
  geometry.spacing_mm = Vec3(0.125, 0.2, 0.25);
  geometry.origin_mm = Vec3(-0.5 * 55 * 0.125, -0.5 * 34 * 0.2, -0.5 * 27 * 0.25);
  const Hole isotropic = mill_hole_in(cube_of(7, 0.125), 1000);
  const Hole hole = mill_hole_in(geometry, 1000);
  EXPECT_NEAR(hole.removed_mm3, isotropic.removed_mm3, 0.02 * isotropic.removed_mm3);
  EXPECT_NEAR(hole.depth_mm, isotropic.depth_mm, 0.125);
}

TEST(BurrMill, CutsARotatedGridLikeAnAxisAlignedOne) {
  const GridGeometry straight = cube_of(7, 0.125);
  GridGeometry turned = straight;
  turned.direction = Quat(0.8, 0.3, -0.4, 0.33).normalized().toRotationMatrix();
  turned.direction.col(1) *= -1;
  turned.origin_mm = turned.direction * straight.origin_mm;
  Volume straight_volume = half_space(straight);
  Volume turned_volume(straight_volume.grid(), 500);
  turned_volume = Volume(DensityGrid(turned, every_nth_density(straight_volume.grid(), 1)), 500);
  BurrMill straight_mill(straight_volume, kRadius_mm, kBone, kMilling);
  BurrMill turned_mill(turned_volume, kRadius_mm, kBone, kMilling);
  double straight_mm3 = 0, turned_mm3 = 0;
  for (int n = 0; n < 300; ++n) {
    const Vec3 centre(0.002 * n, 0.1, 1.4 - 0.002 * n);
    const MillingStep a = straight_mill.step(centre, down(2), 0.001);
    const MillingStep b = turned_mill.step(turned.direction * centre, turned.direction * down(2), 0.001);
    straight_mm3 += a.removed_mm3;
    turned_mm3 += b.removed_mm3;
  }
  EXPECT_NEAR(turned_mm3, straight_mm3, 1e-3 * straight_mm3);
  for_each(straight.all_voxels(),
           [&](const VoxelIndex& v) { ASSERT_NEAR(straight_volume.grid()[v], turned_volume.grid()[v], 2); });
}

TEST(BurrMill, ReportsExactlyTheChangedBox) {
  const GridGeometry geometry = cube_of(6, 0.2);
  Volume volume = half_space(geometry);
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  for (int n = 0; n < 200; ++n) {
    const DensityGrid before = volume.grid();
    const VoxelBox said = mill.step(Vec3(0.01 * n, 0.3, 1.4 - 0.005 * n), down(1), 0.001).change.voxels;
    VoxelBox changed;
    for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
      if (before[v] != volume.grid()[v]) changed.include(v);
    });
    ASSERT_EQ(said.empty(), changed.empty());
    if (changed.empty()) continue;
    ASSERT_EQ(said.first, changed.first);
    ASSERT_EQ(said.last, changed.last);
  }
}

TEST(BurrMill, CutsWithinTheGridWhenTheBurrOverlapsItsEdge) {
  const GridGeometry geometry = cube_of(4, 0.2);
  Volume volume = half_space(geometry);
  BurrMill mill(volume, kRadius_mm, kBone, kMilling);
  const double before_mm3 = charge_mm3(volume.grid(), kBone);
  double removed_mm3 = 0;
  for (int n = 0; n < 500; ++n) {
    removed_mm3 += mill.step(Vec3(2.2, -2.4, -2.0), Vec3(-1, 1, 1).normalized(), 0.001).removed_mm3;
  }
  EXPECT_NEAR(removed_mm3, 1.0, 0.02);
  EXPECT_NEAR(before_mm3 - charge_mm3(volume.grid(), kBone), removed_mm3, 1e-9);
}

TEST(BurrMill, CountsRemovedVolumeExactlyNearFloatResolution) {
  const GridGeometry geometry = cube_of(5, 0.25);
  Volume volume = half_space(geometry);
  BurrMill mill(volume, kRadius_mm, kBone, {1e-2});
  const double before_mm3 = charge_mm3(volume.grid(), kBone);
  double removed_mm3 = 0;
  for (int n = 0; n < 20000; ++n) {
    removed_mm3 += mill.step(Vec3(0, 0, 1.4), down(1e-2), 0.001).removed_mm3;
  }
  EXPECT_NEAR(before_mm3 - charge_mm3(volume.grid(), kBone), removed_mm3, 1e-11);
  EXPECT_GT(removed_mm3, 0);
  EXPECT_LE(removed_mm3, 20000 * 1e-2 * 1e-2 * 0.001 * (1 + 1e-6));
}

TEST(BurrMill, RefusesSettingsOutOfRange) {
  Volume volume = half_space(cube_of(2, 0.25));
  EXPECT_THROW(BurrMill(volume, 0, kBone, kMilling), std::invalid_argument);
  EXPECT_THROW(BurrMill(volume, 1, {5, 5}, {}), std::invalid_argument);
  EXPECT_THROW(BurrMill(volume, 1, kBone, {-1}), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
