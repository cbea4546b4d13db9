#include "osteomill/volume/builtin_tooth.h"

#include <array>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

namespace osteomill {
namespace {

const DensityGrid& tooth() {
  static const DensityGrid grid = builtin_tooth();
  return grid;
}

bool is_bone(const DensityGrid& grid, const VoxelIndex& v) {
  return static_cast<double>(grid[v]) > kBuiltinToothIsovalue;
}

// Returns the number of face-connected components of the wanted voxels of a box.
int count_pieces(const DensityGrid& grid, const VoxelBox& box,
                 const std::function<bool(const VoxelIndex&)>& wanted) {
  std::vector<bool> seen(grid.geometry().voxel_count(), false);
  std::vector<VoxelIndex> open;
  const auto visit = [&](const VoxelIndex& v) {
    if (!box.contains(v) || seen[grid.linear_index(v)] || !wanted(v)) return false;
    seen[grid.linear_index(v)] = true;
    open.push_back(v);
    return true;
  };
  int pieces = 0;
  for (int k = box.first.k; k <= box.last.k; ++k)
    for (int j = box.first.j; j <= box.last.j; ++j)
      for (int i = box.first.i; i <= box.last.i; ++i) {
        if (!visit({i, j, k})) continue;
        ++pieces;
        while (!open.empty()) {
          const VoxelIndex v = open.back();
          open.pop_back();
          for (const int step : {-1, 1}) {
            visit({v.i + step, v.j, v.k});
            visit({v.i, v.j + step, v.k});
            visit({v.i, v.j, v.k + step});
          }
        }
      }
  return pieces;
}

VoxelBox slice(const DensityGrid& grid, int k) {
  VoxelBox box = grid.geometry().all_voxels();
  box.first.k = box.last.k = k;
  return box;
}

double bone_volume_mm3(const DensityGrid& grid) {
  std::size_t count = 0;
  for (const float density : every_nth_density(grid, 1))
    count += static_cast<double>(density) > kBuiltinToothIsovalue;
  return static_cast<double>(count) * grid.geometry().voxel_volume_mm3();
}

TEST(BuiltinTooth, HasGridOfPaperAndIsCentred) {
  const GridGeometry& geometry = tooth().geometry();
  EXPECT_EQ(geometry.dims, (std::array<int, 3>{256, 256, 176}));
  EXPECT_EQ(geometry.spacing_mm, Vec3::Constant(0.125));
  VoxelBox bone;
  for (int k = 0; k < 176; ++k)
    for (int j = 0; j < 256; ++j)
      for (int i = 0; i < 256; ++i)
        if (is_bone(tooth(), {i, j, k})) bone.include({i, j, k});
  EXPECT_NEAR(0.5 * (bone.first.i + bone.last.i), 127.5, 4);
  EXPECT_NEAR(0.5 * (bone.first.j + bone.last.j), 127.5, 4);
  EXPECT_NEAR((bone.last.k - bone.first.k) * 0.125, 20, 1);
  EXPECT_GT(bone.first.k, 3);
  EXPECT_LT(bone.last.k, 172);
}

TEST(BuiltinTooth, IsOnePieceWithTwoRoots) {
  const auto bone = [](const VoxelIndex& v) { return is_bone(tooth(), v); };
  EXPECT_EQ(count_pieces(tooth(), tooth().geometry().all_voxels(), bone), 1);
  EXPECT_EQ(count_pieces(tooth(), slice(tooth(), 40), bone), 2);
  EXPECT_EQ(count_pieces(tooth(), slice(tooth(), 70), bone), 2);
  EXPECT_EQ(count_pieces(tooth(), slice(tooth(), 96), bone), 1);
}

TEST(BuiltinTooth, EndsInFourCusps) {
  EXPECT_EQ(
      count_pieces(tooth(), slice(tooth(), 162), [](const VoxelIndex& v) { return is_bone(tooth(), v); }), 4);
}

TEST(BuiltinTooth, EnclosesItsPulp) {
  // One empty component around the tooth and one inside it: the chamber with its canals.
  const auto empty = [](const VoxelIndex& v) { return !is_bone(tooth(), v); };
  EXPECT_EQ(count_pieces(tooth(), tooth().geometry().all_voxels(), empty), 2);
  EXPECT_NEAR(density_at(tooth(), {0, 0, 13.9}), 40, 1);
  // Outside plus a canal in each root: three components in a slice through the roots.
  EXPECT_EQ(count_pieces(tooth(), slice(tooth(), 60), empty), 3);
}

TEST(BuiltinTooth, EnamelCapOverDentineThinsTowardsNeck) {
  const auto enamel_along = [](const Vec3& from, const Vec3& to) {
    double length_mm = 0;
    const int steps = 2000;
    for (int n = 0; n <= steps; ++n) {
      const double density = density_at(tooth(), from + (static_cast<double>(n) / steps) * (to - from));
      if (density > 2150) length_mm += (to - from).norm() / steps;
    }
    return length_mm;
  };
  const double at_contour_mm = enamel_along({-9, 0, 17}, {-3, 0, 17});
  const double near_neck_mm = enamel_along({0, -9, 13.6}, {0, -3, 13.6});
  const double at_cusp_mm = enamel_along({-2.4, 2.5, 21.9}, {-2.4, 2.5, 17.5});
  EXPECT_GT(at_contour_mm, 1.1);
  EXPECT_LT(at_contour_mm, 2.1);
  EXPECT_GT(at_cusp_mm, 1.5);
  EXPECT_LT(at_cusp_mm, 2.5);
  EXPECT_LT(near_neck_mm, 0.75 * at_contour_mm);
  EXPECT_EQ(enamel_along({0, -9, 10}, {0, 9, 10}), 0);
  EXPECT_NEAR(density_at(tooth(), {-2.8, 2.2, 10.5}), 1500, 1);
}

TEST(BuiltinTooth, IsTheSameToothAtAnyRefinement) {
  const DensityGrid coarse = builtin_tooth(0.5);
  EXPECT_EQ(coarse.geometry().dims, (std::array<int, 3>{128, 128, 88}));
  EXPECT_EQ(coarse.geometry().spacing_mm, Vec3::Constant(0.25));
  EXPECT_NEAR(bone_volume_mm3(coarse) / bone_volume_mm3(tooth()), 1, 0.02);
  // The mean of the eight fine voxels in a coarse one is its density, except at kinks of the edge profile.
  double worst = 0, sum = 0;
  for (int k = 0; k < 88; ++k)
    for (int j = 0; j < 128; ++j)
      for (int i = 0; i < 128; ++i) {
        double mean = 0;
        for (int n = 0; n < 8; ++n) {
          mean += 0.125 *
                  static_cast<double>(tooth()[{2 * i + (n & 1), 2 * j + ((n >> 1) & 1), 2 * k + (n >> 2)}]);
        }
        const double difference = std::abs(mean - static_cast<double>(coarse[{i, j, k}]));
        worst = std::max(worst, difference);
        sum += difference;
      }
  EXPECT_LT(worst, 1400);
  EXPECT_LT(sum / (88 * 128 * 128), 2);
}

TEST(BuiltinTooth, IsIdenticalOnEachCall) {
  EXPECT_EQ(builtin_tooth(0.25).densities(), builtin_tooth(0.25).densities());
}

TEST(BuiltinTooth, RefusesARefinementOutOfRange) {
  EXPECT_THROW(builtin_tooth(0), std::invalid_argument);
  EXPECT_THROW(builtin_tooth(-1), std::invalid_argument);
  EXPECT_THROW(builtin_tooth(100), std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
