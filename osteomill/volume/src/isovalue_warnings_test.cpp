#include <gtest/gtest.h>

#include "osteomill/volume/isovalue.h"
#include "osteomill/volume/volume.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::shape_volume;

TEST(IsovalueWarnings, NameGridFacesThatCutBone) {
  const GridGeometry geometry = centred_cube(40, 0.25);
  EXPECT_TRUE(isovalue_warnings(shape_volume(geometry, ball(Vec3::Zero(), 3)).grid(), 500).empty());
  const auto out_of_two = isovalue_warnings(shape_volume(geometry, ball({4, 0, -4}, 3)).grid(), 500);
  ASSERT_EQ(out_of_two.size(), 1u);
  EXPECT_NE(out_of_two[0].find("(last i, first k)"), std::string::npos) << out_of_two[0];
  // A single layer has one face.
  GridGeometry layer = geometry;
  layer.dims[2] = 1;
  std::vector<float> densities(1600, 0);
  for (const std::size_t n : {820U, 821U}) densities[n] = 700;
  const auto out_of_layer = isovalue_warnings(DensityGrid(layer, densities), 500);
  ASSERT_EQ(out_of_layer.size(), 1u);
  EXPECT_NE(out_of_layer[0].find("(first k)"), std::string::npos) << out_of_layer[0];
}

TEST(IsovalueWarnings, ReportNoBoneOrAllBoneIfIsovalueIsOutOfRange) {
  const DensityGrid grid = shape_volume(centred_cube(10, 1), ball(Vec3::Zero(), 3)).grid();
  EXPECT_TRUE(is_within(grid, 0));
  EXPECT_FALSE(is_within(grid, 1000));
  EXPECT_FALSE(is_within(grid, -1));
  ASSERT_EQ(isovalue_warnings(grid, 1000).size(), 1u);
  EXPECT_NE(isovalue_warnings(grid, 1000)[0].find("0 to 1000: there is no bone"), std::string::npos);
  EXPECT_NE(isovalue_warnings(grid, -1)[0].find("all of it is bone"), std::string::npos);
}

}  // namespace
}  // namespace osteomill
