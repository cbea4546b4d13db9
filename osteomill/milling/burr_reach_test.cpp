#include "osteomill/milling/burr_reach.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

constexpr float kFloor = 300;

GridGeometry turned_geometry() {
  GridGeometry geometry;
  geometry.dims = {30, 24, 20};
  geometry.spacing_mm = Vec3(0.2, 0.25, 0.3);
  geometry.direction = Quat(0.8, 0.3, -0.4, 0.33).normalized().toRotationMatrix();
  geometry.direction.col(0) *= -1;
  geometry.origin_mm = Vec3(1, -2, 3);
  return geometry;
}

Volume random_volume(const GridGeometry& geometry, std::mt19937_64& random) {
  std::vector<float> densities;
  for (std::size_t n = 0; n < geometry.voxel_count(); ++n) {
    densities.push_back(static_cast<float>(random() % 1000));
  }
  return Volume(DensityGrid(geometry, densities), 500);
}

double unit_random(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}

// Every voxel of the grid, one by one. Those on the ball's very surface may be found or not.
void expect_found_as_one_by_one(const BurrReach& reach, const Volume& volume, const Vec3& centre_W,
                                double radius_mm) {
  std::vector<bool> found(volume.geometry().voxel_count(), false);
  for (const BurrReach::Row& row : reach.rows()) {
    for (std::size_t n = row.begin; n < row.end; ++n) {
      const VoxelIndex v{reach.columns()[n], row.j, row.k};
      ASSERT_FALSE(found[volume.grid().linear_index(v)]) << "twice";
      found[volume.grid().linear_index(v)] = true;
      ASSERT_EQ(reach.densities()[n], volume.grid()[v]);
      const double depth_mm = radius_mm - (volume.geometry().world_from_voxel(v) - centre_W).norm();
      ASSERT_NEAR(static_cast<double>(reach.depths_mm()[n]), depth_mm, 1e-6);
    }
  }
  const auto& dims = volume.geometry().dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        const VoxelIndex v{i, j, k};
        const double depth_mm = radius_mm - (volume.geometry().world_from_voxel(v) - centre_W).norm();
        if (std::abs(depth_mm) < 1e-9) continue;
        ASSERT_EQ(found[volume.grid().linear_index(v)], depth_mm > 0 && volume.grid()[v] > kFloor);
      }
}

TEST(BurrReach, FindsWhatAPlainSearchFindsWhileBoneGoesAndTheBallMoves) {
  const GridGeometry geometry = turned_geometry();
  std::mt19937_64 random(11);
  Volume volume = random_volume(geometry, random);
  constexpr double kRadius_mm = 1.3;
  BurrReach reach(geometry, kRadius_mm, kFloor);
  Vec3 voxel(15, 12, 10);
  for (int n = 0; n < 300; ++n) {
    // Small moves, and at times a leap, also to where the ball lies partly or wholly outside the grid.
    for (int axis = 0; axis < 3; ++axis) {
      const double size = n % 23 == 0 ? 20 : n % 3 == 0 ? 0.0 : 0.6;
      voxel[axis] += size * (unit_random(random) - 0.5);
    }
    if (n % 40 == 39) voxel = Vec3(15, 12, 10);
    const Vec3 centre_W = geometry.world_from_voxel(voxel);
    reach.find(volume, centre_W);
    expect_found_as_one_by_one(reach, volume, centre_W, kRadius_mm);
    for (const BurrReach::Row& row : reach.rows()) {
      for (std::size_t at = row.begin; at < row.end; ++at) {
        if (random() % 3 == 0) volume.lower_density({reach.columns()[at], row.j, row.k}, kFloor);
      }
    }
  }
}

TEST(BurrReach, SharesOfLinesTogetherFindAllOnceWhileBoneGoes) {
  // More than 64 bricks along a line, so that a line of bricks takes two words.
  GridGeometry geometry = turned_geometry();
  geometry.dims = {540, 11, 13};
  std::mt19937_64 random(12);
  constexpr double kRadius_mm = 1.7;
  for (const unsigned count : {1u, 2u, 8u, 32u}) {
    Volume volume = random_volume(geometry, random);
    BurrReach whole(geometry, kRadius_mm, kFloor);
    BurrReach shared(geometry, kRadius_mm, kFloor);
    for (int round = 0; round < 3; ++round) {
      // The ball lies across the border of two words.
      const Vec3 centre_W = geometry.world_from_voxel(Vec3(510 + 0.7 * round, 5.2, 6.1));
      whole.find(volume, centre_W);
      ASSERT_GT(whole.size(), 100u);
      std::vector<std::size_t> expected, found;
      const auto list = [&](const BurrReach& reach, std::vector<std::size_t>& voxels) {
        for (const BurrReach::Row& row : reach.rows()) {
          for (std::size_t n = row.begin; n < row.end; ++n) {
            voxels.push_back(volume.grid().linear_index({reach.columns()[n], row.j, row.k}));
          }
        }
      };
      list(whole, expected);
      std::size_t max = 0;
      for (unsigned turn = 0; turn < count; ++turn) {
        shared.find(volume, centre_W, {count, turn});
        list(shared, found);
        max = std::max(max, shared.size());
      }
      std::sort(expected.begin(), expected.end());
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected) << count;
      EXPECT_LE(max, 3 * expected.size() / count + 8) << "lines are shared out evenly";
      for (const std::size_t voxel : expected) {
        const int i = static_cast<int>(voxel % 540), j = static_cast<int>(voxel / 540 % 11);
        if (random() % 3 == 0) volume.lower_density({i, j, static_cast<int>(voxel / (540 * 11))}, kFloor);
      }
    }
  }
}

TEST(BurrReach, HasRoomForABallFullOfBoneAtAnyShift) {
  for (const double radius_mm : {0.05, 0.4, 1.0, 2.7, 20.0}) {
    const GridGeometry geometry = turned_geometry();
    const Volume volume(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 1000.0f)), 500);
    BurrReach reach(geometry, radius_mm, kFloor);
    const std::size_t room_for_rows = reach.rows().capacity();
    for (int n = 0; n < 200; ++n) {
      reach.forget();
      reach.find(volume, geometry.world_from_voxel(Vec3(15 + 0.01 * n, 12 + 0.013 * n, 10 - 0.017 * n)));
      ASSERT_LT(reach.size(), reach.capacity());
      ASSERT_EQ(reach.rows().capacity(), room_for_rows) << "rows were allocated";
    }
    if (radius_mm == 20.0) {
      EXPECT_EQ(reach.size(), geometry.voxel_count());
    }
  }
}

TEST(BurrReach, LooksAtAllAgainInAnotherVolumeOrAfterForgetting) {
  const GridGeometry geometry = turned_geometry();
  const Volume empty(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 0.0f)), 500);
  Volume full(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 1000.0f)), 500);
  const Vec3 centre_W = geometry.world_from_voxel(Vec3(15, 12, 10));
  BurrReach reach(geometry, 1.0, kFloor);
  reach.find(empty, centre_W);
  EXPECT_EQ(reach.size(), 0u);
  reach.find(full, centre_W);
  EXPECT_GT(reach.size(), 100u);
  const std::size_t all = reach.size();
  const Volume another = full;
  full = empty;
  reach.find(full, centre_W);
  EXPECT_EQ(reach.size(), 0u);
  full = another;
  reach.forget();
  reach.find(full, centre_W);
  EXPECT_EQ(reach.size(), all);
}

}  // namespace
}  // namespace osteomill
