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

Vec3 in_grid(const Vec3& voxel, const GridGeometry& geometry) {
  return voxel.cwiseProduct(geometry.spacing_mm);
}

template <typename Visit>
void for_each_found(const BurrReach& reach, const Visit& visit) {
  for (const BurrReach::Piece& piece : reach.pieces()) {
    for (int n = 0; n < 8; ++n) {
      if ((piece.bits >> n & 1) != 0) visit(VoxelIndex{piece.first.i + n, piece.first.j, piece.first.k});
    }
  }
}

// Removes empty entries, as the mill does.
void forget_empty(BurrReach& reach, const Volume& volume) {
  for (const BurrReach::Piece& piece : reach.pieces()) {
    unsigned gone = 0;
    for (int n = 0; n < 8; ++n) {
      const VoxelIndex v{piece.first.i + n, piece.first.j, piece.first.k};
      if ((piece.bits >> n & 1) != 0 && !(volume.grid()[v] > kFloor)) gone |= 1u << n;
    }
    if (gone != 0) reach.forget_voxels(piece, gone);
  }
}

// Tests every voxel of the grid. Voxels exactly on the ball's surface may be found or not. `empty` are those
// found empty before.
void expect_found_as_one_by_one(const BurrReach& reach, const Volume& volume, const Vec3& centre_mm,
                                double radius_mm, std::vector<bool>& empty) {
  std::vector<bool> found(volume.geometry().voxel_count(), false);
  for_each_found(reach, [&](const VoxelIndex& v) {
    ASSERT_TRUE(volume.grid().contains(v));
    ASSERT_FALSE(found[volume.grid().linear_index(v)]) << "twice";
    found[volume.grid().linear_index(v)] = true;
  });
  const auto& dims = volume.geometry().dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        const VoxelIndex v{i, j, k};
        const std::size_t n = volume.grid().linear_index(v);
        const double depth_mm = radius_mm - (in_grid(Vec3(i, j, k), volume.geometry()) - centre_mm).norm();
        if (std::abs(depth_mm) < 1e-9) continue;
        const bool bone = volume.grid()[v] > kFloor;
        if (bone || depth_mm <= 0) {
          ASSERT_EQ(found[n], bone && depth_mm > 0);
        } else if (found[n]) {
          ASSERT_FALSE(empty[n]) << "found again after it was found empty";
          empty[n] = true;
        }
      }
}

TEST(BurrReach, MatchesBruteForceSearchWhileBoneIsCutAndBallMoves) {
  const GridGeometry geometry = turned_geometry();
  std::mt19937_64 random(11);
  Volume volume = random_volume(geometry, random);
  constexpr double kRadius_mm = 1.3;
  BurrReach reach(volume, kRadius_mm, kFloor);
  std::vector<bool> empty(geometry.voxel_count(), false);
  Vec3 voxel(15, 12, 10);
  for (int n = 0; n < 300; ++n) {
    // Small moves and occasional jumps, also partly or wholly out of the grid.
    for (int axis = 0; axis < 3; ++axis) {
      const double size = n % 23 == 0 ? 20 : n % 3 == 0 ? 0.0 : 0.6;
      voxel[axis] += size * (unit_random(random) - 0.5);
    }
    if (n % 40 == 39) voxel = Vec3(15, 12, 10);
    const double radius_mm = n % 5 == 0 ? 0.7 * kRadius_mm : kRadius_mm;
    reach.find(in_grid(voxel, geometry), radius_mm);
    expect_found_as_one_by_one(reach, volume, in_grid(voxel, geometry), radius_mm, empty);
    forget_empty(reach, volume);
    for_each_found(reach, [&](const VoxelIndex& v) {
      if (random() % 3 == 0) volume.lower_density(v, kFloor);
    });
  }
}

TEST(BurrReach, SharesOfLinesTogetherFindEachVoxelExactlyOnce) {
  // More than 64 bricks along a line, which needs two words.
  GridGeometry geometry = turned_geometry();
  geometry.dims = {540, 11, 13};
  std::mt19937_64 random(12);
  constexpr double kRadius_mm = 1.7;
  for (const unsigned count : {1u, 2u, 8u, 32u}) {
    Volume volume = random_volume(geometry, random);
    BurrReach whole(volume, kRadius_mm, kFloor);
    BurrReach shared(volume, kRadius_mm, kFloor);
    for (int round = 0; round < 3; ++round) {
      // The ball spans the border of two words.
      const Vec3 centre_mm = in_grid(Vec3(510 + 0.7 * round, 5.2, 6.1), geometry);
      whole.find(centre_mm, kRadius_mm);
      std::vector<std::size_t> expected, found;
      const auto list = [&](const BurrReach& reach, std::vector<std::size_t>& voxels) {
        for_each_found(reach, [&](const VoxelIndex& v) { voxels.push_back(volume.grid().linear_index(v)); });
      };
      list(whole, expected);
      ASSERT_GT(expected.size(), 100u);
      std::size_t max = 0;
      for (unsigned turn = 0; turn < count; ++turn) {
        shared.find(centre_mm, kRadius_mm, {count, turn});
        const std::size_t before = found.size();
        list(shared, found);
        max = std::max(max, found.size() - before);
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

TEST(BurrReach, ReservesRoomForABallFullOfBoneAtAnyOffset) {
  for (const double radius_mm : {0.05, 0.4, 1.0, 2.7, 20.0}) {
    const GridGeometry geometry = turned_geometry();
    const Volume volume(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 1000.0f)), 500);
    BurrReach reach(volume, radius_mm, kFloor);
    const std::size_t room = reach.pieces().capacity();
    std::size_t found = 0;
    for (int n = 0; n < 200; ++n) {
      reach.find(in_grid(Vec3(15 + 0.01 * n, 12 + 0.013 * n, 10 - 0.017 * n), geometry), radius_mm);
      found = 0;
      for_each_found(reach, [&](const VoxelIndex&) { ++found; });
      ASSERT_LE(found, reach.max_voxels());
      ASSERT_EQ(reach.pieces().capacity(), room) << "pieces were allocated";
    }
    if (radius_mm == 20.0) {
      EXPECT_EQ(found, geometry.voxel_count());
    }
  }
}

TEST(BurrReach, LimitsPiecesToTheGivenCapacity) {
  const GridGeometry geometry = turned_geometry();
  const Volume volume(DensityGrid(geometry, std::vector<float>(geometry.voxel_count(), 1000.0f)), 500);
  BurrReach reach(volume, 2.0, kFloor, 20);
  reach.find(in_grid(Vec3(15, 12, 10), geometry), 2.0);
  EXPECT_EQ(reach.pieces().size(), 20u);
  EXPECT_EQ(reach.max_voxels(), 160u);
}

}  // namespace
}  // namespace osteomill
