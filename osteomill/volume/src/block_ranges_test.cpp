#include "osteomill/volume/block_ranges.h"

#include <random>

#include <gtest/gtest.h>

#include "osteomill/volume/volume.h"

namespace osteomill {
namespace {

DensityGrid random_grid() {
  GridGeometry geometry;
  geometry.dims = {19, 8, 25};
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> density(-1000, 3000);
  std::vector<float> densities(geometry.voxel_count());
  for (float& value : densities) value = density(random);
  return DensityGrid(geometry, densities);
}

void expect_ranges_hold(const BlockRanges& bricks, const DensityGrid& grid, bool exact) {
  for (int bk = 0; bk < bricks.dims()[2]; ++bk) {
    for (int bj = 0; bj < bricks.dims()[1]; ++bj) {
      for (int bi = 0; bi < bricks.dims()[0]; ++bi) {
        float min = 1e9f, max = -1e9f;
        for (int k = 8 * bk; k <= 8 * bk + 8; ++k)
          for (int j = 8 * bj; j <= 8 * bj + 8; ++j)
            for (int i = 8 * bi; i <= 8 * bi + 8; ++i) {
              if (!grid.contains({i, j, k})) continue;
              min = std::min(min, grid[{i, j, k}]);
              max = std::max(max, grid[{i, j, k}]);
            }
        EXPECT_EQ(bricks.at(bi, bj, bk).min, min);
        if (exact) {
          EXPECT_EQ(bricks.at(bi, bj, bk).max, max);
        }
        EXPECT_GE(bricks.at(bi, bj, bk).max, max);
      }
    }
  }
}

TEST(BlockRanges, MatchExtremesOfEachBrickAndItsUpperNeighbours) {
  const DensityGrid grid = random_grid();
  const BlockRanges bricks(grid);
  EXPECT_EQ(bricks.dims(), (std::array<int, 3>{3, 1, 4}));
  expect_ranges_hold(bricks, grid, true);
}

TEST(BlockRanges, HoldAfterRowsAreLowered) {
  Volume volume(random_grid(), 500);
  const std::vector<int> columns{0, 1, 7, 8, 11, 15, 16, 18};
  for (const int j : {0, 5}) {
    for (const int k : {0, 7, 8, 24}) {
      std::vector<float> densities;
      for (const int i : columns) densities.push_back(-2000.0f - static_cast<float>(i * j + k));
      volume.lower_row(j, k, columns.data(), densities.data(), columns.size());
      for (std::size_t n = 0; n < columns.size(); ++n) {
        EXPECT_EQ((volume.grid()[{columns[n], j, k}]), densities[n]);
      }
      expect_ranges_hold(volume.ranges(), volume.grid(), false);
    }
  }
}

TEST(BlockRanges, HoldWhileDensitiesFallAndAreExactAfterARefresh) {
  Volume volume(random_grid(), 500);
  const VoxelBox box{{6, 2, 7}, {17, 7, 16}};
  for (int k = box.first.k; k <= box.last.k; ++k)
    for (int j = box.first.j; j <= box.last.j; ++j)
      for (int i = box.first.i; i <= box.last.i; ++i) volume.lower_density({i, j, k}, -2000.0f - float(i));
  expect_ranges_hold(volume.ranges(), volume.grid(), false);
  BlockRanges ranges = volume.ranges();
  ranges.refresh(volume.grid(), box);
  expect_ranges_hold(ranges, volume.grid(), true);
}

TEST(BlockRanges, ChangeCounterDiffersAfterEachUpdateInBox) {
  Volume volume(random_grid(), 500);
  const VoxelBox all = volume.geometry().all_voxels();
  const BlockRanges& ranges = volume.ranges();
  for (const VoxelIndex& v : {VoxelIndex{0, 0, 0}, all.last, VoxelIndex{8, 7, 8}, VoxelIndex{7, 3, 16}}) {
    const VoxelBox near = VoxelBox{v, v}.grown(2).intersected(all);
    const std::uint32_t before = ranges.changes_in(near), of_all = ranges.changes_in(all);
    EXPECT_EQ(ranges.changes_in(near), before);
    volume.lower_density(v, -3000);
    EXPECT_NE(ranges.changes_in(near), before);
    EXPECT_NE(ranges.changes_in(all), of_all);
    const std::uint32_t lowered = ranges.changes_in(near);
    const float lower = -4000;
    volume.lower_row(v.j, v.k, &v.i, &lower, 1);
    EXPECT_NE(ranges.changes_in(near), lowered);
    const std::uint32_t again = ranges.changes_in(near);
    BlockRanges refreshed = ranges;
    refreshed.refresh(volume.grid(), {v, v});
    EXPECT_NE(refreshed.changes_in(near), again);
  }
}

}  // namespace
}  // namespace osteomill
