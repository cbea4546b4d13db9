#include "osteomill/volume/bone_pieces.h"

#include <algorithm>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/density_grid.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;

constexpr double kIsovalue = 0.5;

DensityGrid made_of(const GridGeometry& geometry, const std::function<bool(const VoxelIndex&)>& is_bone) {
  std::vector<float> densities;
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) { densities.push_back(is_bone(v) ? 1 : -1); });

  return DensityGrid(geometry, std::move(densities));
}

// Reference flood fill, voxel by voxel.
std::vector<std::vector<VoxelIndex>> filled_pieces(const DensityGrid& grid) {
  std::vector<bool> seen(grid.geometry().voxel_count());
  std::vector<std::vector<VoxelIndex>> pieces;
  for_each(grid.geometry().all_voxels(), [&](const VoxelIndex& start) {
    std::vector<VoxelIndex> waiting{start};
    std::vector<VoxelIndex> piece;
    while (!waiting.empty()) {
      const VoxelIndex v = waiting.back();
      waiting.pop_back();
      if (!grid.contains(v) || seen[grid.linear_index(v)] || static_cast<double>(grid[v]) <= kIsovalue)
        continue;
      seen[grid.linear_index(v)] = true;
      piece.push_back(v);
      for_each({{v.i - 1, v.j - 1, v.k - 1}, {v.i + 1, v.j + 1, v.k + 1}},
               [&](const VoxelIndex& next) { waiting.push_back(next); });
    }
    if (!piece.empty()) pieces.push_back(std::move(piece));
  });
  return pieces;
}

std::vector<std::size_t> filled_sizes(const DensityGrid& grid) {
  std::vector<std::size_t> sizes;
  for (const auto& piece : filled_pieces(grid)) sizes.push_back(piece.size());
  std::sort(sizes.begin(), sizes.end(), std::greater<>());
  return sizes;
}

TEST(BonePieces, SizesMatchFloodFillAtAnyShareOfBone) {
  std::mt19937 random(7);
  GridGeometry geometry = centred_cube(1, 0.5);
  for (const auto& dims :
       {std::array{13, 11, 9}, std::array{1, 17, 5}, std::array{20, 1, 1}, std::array{2, 2, 30}}) {
    geometry.dims = dims;
    for (const double share : {0.02, 0.05, 0.1, 0.2, 0.9}) {
      std::bernoulli_distribution is_bone(share);
      const DensityGrid grid = made_of(geometry, [&](const VoxelIndex&) { return is_bone(random); });
      EXPECT_EQ(filled_sizes(grid), piece_sizes(grid, kIsovalue)) << share;
    }
  }
}

// Covers every piece of random bones, chosen by each of its voxels, and each kind of removal.
TEST(BonePieces, RemovalMatchesFloodFill) {
  std::mt19937 random(11);
  GridGeometry geometry = centred_cube(1, 0.5);
  std::size_t removals = 0;
  for (const auto& dims : {std::array{13, 11, 9}, std::array{1, 17, 5}, std::array{20, 1, 1}}) {
    geometry.dims = dims;
    for (const double share : {0.05, 0.1, 0.2}) {
      std::bernoulli_distribution is_bone(share);
      const DensityGrid grid = made_of(geometry, [&](const VoxelIndex&) { return is_bone(random); });
      const auto pieces = filled_pieces(grid);
      const auto expect_left = [&](const PieceRemoval& removal, const auto& is_removed) {
        DensityGrid left = grid, expected = grid;
        const std::vector<DensityBlock> bricks = bricks_without(grid, kIsovalue, removal, 1000);
        for (const DensityBlock& brick : bricks) {
          bool changed = false;
          for_each(brick.voxels_in(geometry), [&](const VoxelIndex& v) {
            changed = changed || brick.densities[brick.index_of(v)] != grid[v];
            left.set(v, brick.densities[brick.index_of(v)]);
          });
          EXPECT_TRUE(changed);
        }
        for (const auto& piece : pieces) {
          if (is_removed(piece))
            for (const VoxelIndex& v : piece) expected.set(v, grid.outside_density());
        }
        ++removals;
        EXPECT_EQ(expected.densities(), left.densities());
      };
      for (const auto& chosen : pieces) {
        VoxelBox box;
        for (const VoxelIndex& v : chosen) box.include(v);
        for (const VoxelIndex& v : {chosen.front(), chosen.back(), chosen[chosen.size() / 2]}) {
          const auto piece = piece_at(grid, kIsovalue, v);
          ASSERT_TRUE(piece);
          EXPECT_EQ(chosen.size(), piece->voxels);
          EXPECT_EQ(box, piece->box);
          EXPECT_EQ(filled_sizes(grid), piece->sizes);
          expect_left({PieceRemoval::Which::chosen, v}, [&](const auto& one) { return &one == &chosen; });
          expect_left({PieceRemoval::Which::all_but_chosen, v},
                      [&](const auto& one) { return &one != &chosen; });
        }
        const double min_mm3 = static_cast<double>(chosen.size()) * geometry.voxel_volume_mm3();
        expect_left({PieceRemoval::Which::smaller, {}, min_mm3},
                    [&](const auto& one) { return one.size() < chosen.size(); });
      }
    }
  }
  EXPECT_GT(removals, 500u);
}

// A ball of 6 mm, one of 3 mm and a lone voxel in a grid of 0.25 mm.
class BonePiecesTest : public testing::Test {
 protected:
  static bool is_in(const Vec3& p, double x_mm, double radius_mm) {
    return (p - Vec3(x_mm, 0, 0)).norm() < radius_mm;
  }
  DensityGrid grid() const {
    return made_of(geometry_, [&](const VoxelIndex& v) {
      const Vec3 p = geometry_.world_from_voxel(v);
      return is_in(p, -3.5, 6) || is_in(p, 7.5, 3) || v == lone_;
    });
  }
  static double mm3(double radius_mm) { return 4.0 / 3 * std::numbers::pi * std::pow(radius_mm, 3); }

  GridGeometry geometry_ = centred_cube(100, 0.25);
  VoxelIndex lone_{97, 97, 97};
};

TEST_F(BonePiecesTest, SizesMatchVolumesOfBalls) {
  const std::vector<std::size_t> sizes = piece_sizes(grid(), kIsovalue);
  ASSERT_EQ(3u, sizes.size());
  EXPECT_NEAR(mm3(6), static_cast<double>(sizes[0]) * geometry_.voxel_volume_mm3(), 0.01 * mm3(6));
  EXPECT_NEAR(mm3(3), static_cast<double>(sizes[1]) * geometry_.voxel_volume_mm3(), 0.01 * mm3(3));
  EXPECT_EQ(1u, sizes[2]);
}

TEST_F(BonePiecesTest, DiscardsAllButTheLargestIfRequested) {
  DensityGrid left = grid();
  const DiscardedPieces out = discard_pieces(left, kIsovalue, {.only_largest = true});
  EXPECT_EQ(2u, out.pieces);
  EXPECT_EQ(1u, out.kept);
  EXPECT_EQ(piece_sizes(grid(), kIsovalue)[1] + 1, out.voxels);
  for_each(geometry_.all_voxels(), [&](const VoxelIndex& v) {
    ASSERT_EQ(is_in(geometry_.world_from_voxel(v), -3.5, 6) ? 1 : -1, left[v]);
  });
}

TEST_F(BonePiecesTest, DiscardsPiecesBelowMinimumVolume) {
  const auto kept = [&](const PieceChoice& choice) {
    DensityGrid left = grid();
    return discard_pieces(left, kIsovalue, choice).kept;
  };
  EXPECT_EQ(3u, kept({}));
  EXPECT_EQ(3u, kept({.min_mm3 = geometry_.voxel_volume_mm3()}));
  EXPECT_EQ(2u, kept({.min_mm3 = 1.001 * geometry_.voxel_volume_mm3()}));
  EXPECT_EQ(1u, kept({.min_mm3 = 1.02 * mm3(3)}));
  EXPECT_EQ(0u, kept({.min_mm3 = 1.02 * mm3(6)}));
}

TEST_F(BonePiecesTest, RefusesEmptyVoxelsAndTooManyBricks) {
  const VoxelIndex in_small{80, 49, 49};
  EXPECT_FALSE(piece_at(grid(), kIsovalue, {0, 0, 0}));
  EXPECT_THROW(bricks_without(grid(), kIsovalue, {PieceRemoval::Which::chosen, {0, 0, 0}}, 1000),
               std::invalid_argument);
  const auto bricks = bricks_without(grid(), kIsovalue, {PieceRemoval::Which::chosen, in_small}, 1000);
  EXPECT_THROW(bricks_without(grid(), kIsovalue, {PieceRemoval::Which::chosen, in_small}, bricks.size() - 1),
               std::length_error);
  EXPECT_NO_THROW(bricks_without(grid(), kIsovalue, {PieceRemoval::Which::chosen, in_small}, bricks.size()));
}

TEST(BonePieces, AreAbsentWithoutBone) {
  DensityGrid none = made_of(centred_cube(4, 1), [](const VoxelIndex&) { return false; });
  EXPECT_TRUE(piece_sizes(none, kIsovalue).empty());
  EXPECT_EQ(0u, discard_pieces(none, kIsovalue, {.only_largest = true}).pieces);
}

}  // namespace
}  // namespace osteomill
