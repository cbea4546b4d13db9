#include "osteomill/haptics/barrier_shell/surface_lattice.h"

#include <memory>
#include <numbers>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/haptics/barrier_shell/bone_bricks.h"

namespace osteomill::barrier_shell {
namespace {

template <typename F>
void for_each_point(const BrickPoints& points, const SurfaceLattice& lattice, BoneBricks& bricks, F&& f) {
  const auto& dims = lattice.brick_dims();
  for (int k = 0; k < dims[2]; ++k) {
    for (int j = 0; j < dims[1]; ++j) {
      for (int i = 0; i < dims[0]; ++i) {
        const std::uint32_t slot = bricks.slot_of({i, j, k});
        if (slot == BoneBricks::kNoPoints) continue;
        std::uint32_t left = points.brick(slot).count;
        for (std::uint32_t c = points.brick(slot).first_chunk; c != BrickPoints::kNoChunk;
             c = points.next_chunk(c)) {
          for (std::size_t s = 0; s < PointChunk::kSlots && left > 0; ++s, --left) {
            const ShellPoint p = points.chunk(c).point(s);
            const Vec3 local(static_cast<double>(p.x_mm), static_cast<double>(p.y_mm),
                             static_cast<double>(p.z_mm));
            f(Vec3(lattice.origin_W() + lattice.direction() * (lattice.brick_origin_G({i, j, k}) + local)),
              static_cast<double>(p.area_mm2));
          }
        }
      }
    }
  }
}

struct BallFigures {
  double area_mm2 = 0;
  double worst_off_mm = 0;
  int points = 0;
};

BallFigures figures(const BrickPoints& points, BoneBricks& bricks, double radius_mm) {
  BallFigures f;
  for_each_point(points, bricks.lattice(), bricks, [&](const Vec3& point_W, double area_mm2) {
    f.area_mm2 += area_mm2;
    f.worst_off_mm = std::max(f.worst_off_mm, std::abs(point_W.norm() - radius_mm));
    ++f.points;
  });
  return f;
}

// At every resolution about as many points, on the ball, that add up to its area.
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

// A block of bone that fills the grid has its surface at the border; one with a cut plane at the plane too.
TEST(SurfaceLattice, TheGridsBorderIsASurface) {
  const Volume volume = testing_support::shape_volume(testing_support::centred_cube(21, 0.1),
                                                      testing_support::plane({0, 0, 0.45}, {0, 0, 1}));
  BoneBricks bricks(volume, 0.13);
  double area_mm2 = 0;
  for_each_point(bricks.fine(), bricks.lattice(), bricks,
                 [&](const Vec3&, double area) { area_mm2 += area; });
  // Two faces of 2.05 mm and four of 2.05 by 1.5, each edge rounded over a voxel.
  EXPECT_NEAR(area_mm2, 2 * 2.05 * 2.05 + 4 * 2.05 * 1.5, 1.2);
}

// Bricks brought up to date by the sweep, a little a tick, hold in the end what bricks made anew hold; on the
// way no part of the old surface is missing before the new one is there.
TEST(BoneBricks, MillingBringsThemUpToDateWithinABudget) {
  for (const double voxel_mm : {0.06, 0.125, 0.4}) {
    Volume volume =
        testing_support::shape_volume(testing_support::centred_cube(static_cast<int>(6 / voxel_mm), voxel_mm),
                                      testing_support::ball(Vec3::Zero(), 2));
    BoneBricks kept(volume, 0.13);
    figures(kept.fine(), kept, 2);
    VoxelBox changed;
    const auto& dims = volume.geometry().dims;
    for (int k = 0; k < dims[2]; ++k) {
      for (int j = 0; j < dims[1]; ++j) {
        for (int i = 0; i < dims[0]; ++i) {
          const double distance =
              (volume.geometry().world_from_voxel(VoxelIndex{i, j, k}) - Vec3(0, 0, 1.6)).norm();
          const float max = static_cast<float>(1000 * std::clamp((distance - 1.2) / 0.5, 0.0, 1.0));
          if (volume.grid()[{i, j, k}] <= max) continue;
          volume.lower_density({i, j, k}, max);
          changed.include({i, j, k});
        }
      }
    }
    kept.refresh(changed, 200);
    int ticks = 1;
    for (; !kept.is_up_to_date(); ++ticks) kept.refresh({}, 200);
    EXPECT_GT(ticks, 3);
    BoneBricks anew(volume, 0.13);
    std::vector<Vec3> kept_points, new_points;
    for_each_point(kept.fine(), kept.lattice(), kept,
                   [&](const Vec3& p, double) { kept_points.push_back(p); });
    for_each_point(anew.fine(), anew.lattice(), anew,
                   [&](const Vec3& p, double) { new_points.push_back(p); });
    EXPECT_EQ(kept_points, new_points) << voxel_mm;
    EXPECT_EQ(kept.octree().total(), anew.octree().total());
  }
}

}  // namespace
}  // namespace osteomill::barrier_shell
