#include "osteomill/volume/label_map.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;

std::vector<Label> three_labels() {
  return {{7, "shell", {255, 0, 0}}, {9, "core", {0, 255, 0}, true}, {12, "unused", {0, 0, 255}}};
}

// Shell with a core, off-centre.
std::vector<LabelMap::LabelIndex> shell_and_core(const GridGeometry& grid) {
  std::vector<LabelMap::LabelIndex> places;
  for (int k = 0; k < grid.dims[2]; ++k) {
    for (int j = 0; j < grid.dims[1]; ++j) {
      for (int i = 0; i < grid.dims[0]; ++i) {
        const double from_mm = (grid.world_from_voxel(VoxelIndex{i, j, k}) - Vec3(0.3, -0.2, 0.1)).norm();
        places.push_back(from_mm < 1.0 ? 2 : from_mm < 2.0 ? 1 : 0);
      }
    }
  }
  return places;
}

TEST(LabelMap, KeepsEveryVoxelOnTheScansGrid) {
  const GridGeometry scan = centred_cube(21, 0.25);
  const std::vector<LabelMap::LabelIndex> places = shell_and_core(scan);
  const LabelMap map(three_labels(), scan, scan, places);
  std::vector<std::size_t> counts(4);
  std::size_t n = 0;
  VoxelBox core;
  for (int k = 0; k < 21; ++k) {
    for (int j = 0; j < 21; ++j) {
      for (int i = 0; i < 21; ++i, ++n) {
        const VoxelIndex v{i, j, k};
        ASSERT_EQ(map.at(v), places[n]);
        ++counts[places[n]];
        if (places[n] == 2) core.include(v);
      }
    }
  }
  counts[0] = 0;
  EXPECT_EQ(map.voxel_counts(), counts);
  EXPECT_EQ(map.no_go_box(), core);
  EXPECT_EQ(map.at({-1, 5, 5}), 0);
  EXPECT_EQ(map.at({5, 21, 5}), 0);
}

// Compares with a brute-force search for the nearest voxel of the map.
TEST(LabelMap, TakesNearestLabelOnAnotherGrid) {
  GridGeometry scan = centred_cube(17, 0.31);
  scan.direction = quaternion_from_rotation_vector({0.3, -0.5, 0.2}).toRotationMatrix();
  GridGeometry own;
  own.dims = {11, 13, 9};
  own.spacing_mm = {0.43, 0.37, 0.52};
  own.direction = quaternion_from_rotation_vector({-0.7, 0.1, 0.4}).toRotationMatrix();
  own.direction.col(0) = -own.direction.col(0);
  own.origin_mm = Vec3(0.21, -0.33, 0.17) - own.direction * own.spacing_mm.cwiseProduct(Vec3(5, 6, 4));
  const std::vector<LabelMap::LabelIndex> places = shell_and_core(own);
  const LabelMap map(three_labels(), scan, own, places);
  std::size_t labelled = 0;
  for (int k = 0; k < 17; ++k) {
    for (int j = 0; j < 17; ++j) {
      for (int i = 0; i < 17; ++i) {
        const Vec3 point_W = scan.world_from_voxel(VoxelIndex{i, j, k});
        double least = 1e300;
        LabelMap::LabelIndex expected = 0;
        std::size_t n = 0;
        for (int c = 0; c < own.dims[2]; ++c) {
          for (int b = 0; b < own.dims[1]; ++b) {
            for (int a = 0; a < own.dims[0]; ++a, ++n) {
              const Vec3 away =
                  own.direction.transpose() * (own.world_from_voxel(VoxelIndex{a, b, c}) - point_W);
              // Voxel whose box contains the point.
              const double far = away.cwiseAbs().cwiseQuotient(own.spacing_mm).maxCoeff();
              if (far >= least || far > 0.5) continue;
              least = far;
              expected = places[n];
            }
          }
        }
        ASSERT_EQ(map.at({i, j, k}), expected) << i << " " << j << " " << k;
        ASSERT_EQ(map.nearest_to(point_W), expected);
        labelled += expected != 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(labelled, 500u);
}

TEST(LabelMap, LabelsNothingIfItDoesNotOverlapTheScan) {
  const GridGeometry scan = centred_cube(9, 0.5);
  GridGeometry own = scan;
  own.origin_mm += Vec3(1e6, 0, 0);
  const LabelMap map(three_labels(), scan, own, shell_and_core(scan));
  EXPECT_TRUE(map.box().empty());
  EXPECT_EQ(map.at({4, 4, 4}), 0);
}

TEST(LabelMap, RefusesInvalidIndicesWrongSizeAndTooManyLabels) {
  const GridGeometry scan = centred_cube(2, 1);
  EXPECT_THROW(LabelMap(three_labels(), scan, scan, {0, 1, 2, 3, 4, 0, 0, 0}), std::invalid_argument);
  EXPECT_THROW(LabelMap(three_labels(), scan, scan, {0, 1}), std::invalid_argument);
  EXPECT_THROW(LabelMap(std::vector<Label>(256), scan, scan, std::vector<LabelMap::LabelIndex>(8)),
               std::invalid_argument);
}

}  // namespace
}  // namespace osteomill
