#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/isovalue.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;

// Air, soft tissue within kSkin_mm of the centre and bone within kBone_mm, with edges two voxels wide.
DensityGrid head(double soft, double bone, double noise, Vec3 spacing_mm = {0.5, 0.5, 0.5}) {
  constexpr double kSkin_mm = 9, kBone_mm = 6;
  GridGeometry geometry = centred_cube(48, 0.5);
  geometry.spacing_mm = spacing_mm;
  geometry.origin_mm = -23.5 * spacing_mm;
  std::mt19937_64 random(3);
  std::normal_distribution<double> shot(0, noise);
  const auto step = [](double inside_mm) { return std::clamp(0.5 + inside_mm, 0.0, 1.0); };
  std::vector<float> densities;
  for_each(geometry.all_voxels(), [&](const VoxelIndex& v) {
    const double from_mm = geometry.world_from_voxel(v).norm();
    densities.push_back(static_cast<float>(soft * step(kSkin_mm - from_mm) +
                                           (bone - soft) * step(kBone_mm - from_mm) + shot(random)));
  });
  return DensityGrid(geometry, std::move(densities));
}

TEST(Boundaries, FindsBothSkinAndBone) {
  for (const double scale : {1.0, 0.05, 40.0}) {
    for (const Vec3& spacing_mm : {Vec3(0.5, 0.5, 0.5), Vec3(0.4, 0.4, 0.8)}) {
      const auto found = boundaries_in(head(1000 * scale, 2500 * scale, 20 * scale, spacing_mm));
      ASSERT_EQ(found.size(), 2u);
      EXPECT_NEAR(found[0].below, 0, 60 * scale);
      EXPECT_NEAR(found[0].density, 500 * scale, 250 * scale);
      EXPECT_NEAR(found[0].above, 1000 * scale, 60 * scale);
      EXPECT_NEAR(found[1].below, 1000 * scale, 60 * scale);
      EXPECT_NEAR(found[1].density, 1750 * scale, 375 * scale);
      EXPECT_NEAR(found[1].above, 2500 * scale, 60 * scale);
    }
  }
}

TEST(Boundaries, UniformVolumeHasNoneAndOneMaterialHasOne) {
  EXPECT_TRUE(boundaries_in(head(0, 0, 0)).empty());
  EXPECT_EQ(boundaries_in(head(1000, 1000, 20)).size(), 1u);
}

}  // namespace
}  // namespace osteomill
