#include "osteomill/visual/clip_face.h"

#include <map>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

// Densities 100 x + 10 y + z in W, so that every sample of a cut is known.
DensityGrid ramp(const GridGeometry& geometry) {
  std::vector<float> densities;
  for (int k = 0; k < geometry.dims[2]; ++k) {
    for (int j = 0; j < geometry.dims[1]; ++j) {
      for (int i = 0; i < geometry.dims[0]; ++i) {
        const Vec3 p = geometry.world_from_voxel(VoxelIndex{i, j, k});
        densities.push_back(static_cast<float>(p.dot(Vec3(10, 3, 1))));
      }
    }
  }
  return DensityGrid(geometry, std::move(densities));
}

TEST(ClipFace, ShowsDensitiesInItsPlane) {
  const DensityGrid grid = ramp(testing_support::centred_cube(41, 0.25));
  for (const Vec3& normal : {Vec3(0, 0, 1), Vec3(1, 0, 0), Vec3(0.3, -0.5, 0.8)}) {
    const ClipPlane plane{normal.normalized(), 0.7};
    const ClipFace face = clip_face(grid, plane, {-100, 155});
    ASSERT_GT(face.width, 20);
    ASSERT_GT(face.height, 20);
    ASSERT_EQ(face.pixels.size(), static_cast<std::size_t>(face.width * face.height));
    for (const Vec3& corner : face.corners_W) EXPECT_NEAR(plane.normal_W.dot(corner), 0.7, 1e-9);
    for (int y = 0; y < face.height; y += 5) {
      for (int x = 0; x < face.width; x += 5) {
        const double u = x / (face.width - 1.0);
        const double v = y / (face.height - 1.0);
        const Vec3 point_W = face.corners_W[0] + u * (face.corners_W[1] - face.corners_W[0]) +
                             v * (face.corners_W[3] - face.corners_W[0]);
        if (point_W.cwiseAbs().maxCoeff() > 4.99) continue;
        const int grey = face.pixels[static_cast<std::size_t>(x + face.width * y)][0];
        EXPECT_NEAR(grey, point_W.dot(Vec3(10, 3, 1)) + 100, 1.01);
      }
    }
  }
}

TEST(ClipFace, IsEmptyIfPlaneMissesGrid) {
  const DensityGrid grid = ramp(testing_support::centred_cube(21, 0.25));
  EXPECT_TRUE(clip_face(grid, {Vec3::UnitX(), 30}, {0, 1}).pixels.empty());
}

TEST(ClipFace, LimitsPixelsOfLargeFaces) {
  const DensityGrid grid = ramp(testing_support::centred_cube(60, 0.25));
  const ClipFace face = clip_face(grid, {Vec3::UnitX(), 0}, {0, 1}, nullptr, 30);
  EXPECT_LE(face.width, 31);
  EXPECT_LE(face.height, 31);
}

TEST(ClipFace, ExtentAlongAnAxisSpansTheGrid) {
  const GridGeometry cube = testing_support::centred_cube(41, 0.25);
  const auto extent = extent_along(corners_W(cube, cube.all_voxels()), Vec3::UnitY());
  EXPECT_NEAR(extent[0], -5, 1e-9);
  EXPECT_NEAR(extent[1], 5, 1e-9);
}

TEST(ClipFace, ShowsTheLabelsOfTheNearestVoxels) {
  const GridGeometry geometry = testing_support::centred_cube(8, 1.0);
  std::vector<LabelMap::LabelIndex> places;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 8; ++i) places.push_back(i < 4 ? 0 : j < 4 ? 1 : 2);
  const LabelMap labels({{1, "a", {10, 20, 30}}, {2, "b", {40, 50, 60}}}, geometry, geometry, places);
  const DensityGrid grid(geometry, std::vector<float>(geometry.voxel_count(), 100.0f));
  const ClipFace face = clip_face(grid, {Vec3::UnitZ(), 0.1}, {0, 200}, &labels);
  std::map<std::array<unsigned char, 3>, int> counts;
  for (const auto& colour : face.pixels) ++counts[colour];
  // 0.45 times the grey value plus 0.55 x 0.67 times the label's colour.
  EXPECT_EQ((counts[{127, 127, 127}]), 32);
  EXPECT_EQ((counts[{60, 64, 68}]), 16);
  EXPECT_EQ((counts[{71, 75, 79}]), 16);
}

}  // namespace
}  // namespace osteomill
