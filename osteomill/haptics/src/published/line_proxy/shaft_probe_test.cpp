#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/sampling.h"

#include "published/line_proxy/intersection.h"
#include "tests/shapes.h"

namespace osteomill::line_proxy {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

const std::vector<Vec3> kShaft{{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}};

TEST(ShaftProbe, FindsTheDensestPointBetweenVertices) {
  // The axis passes the centre of a small ball, whose density is highest nearest to it: 2.75 up the shaft,
  // between two vertices but on a sub-step of the one at 3.
  const Volume bone = shape_volume(centred_cube(48, 0.25), ball(Vec3(0, 0.9, 2.75), 1.0), 4.0);
  const ShaftProbe probe = densest_point(bone, kShaft, Pose{}, Vec3(0, 0, 3));
  EXPECT_LT((probe.point_W - Vec3(0, 0, 2.75)).norm(), 1e-9);
  EXPECT_GT(probe.density, bone.isovalue());
}

TEST(ShaftProbe, ReturnsTheMiddleOfEquallyDensePoints) {
  // Saturated from z = 1.5 up: the sub-steps of a quarter from 1.5 to 4 are equally dense.
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3(0, 0, 1.125), -Vec3::UnitZ()));
  const ShaftProbe probe = densest_point(bone, kShaft, Pose{}, Vec3(0, 0, 3));
  EXPECT_NEAR(probe.point_W.z(), 2.75, 1e-9);
}

TEST(ShaftProbe, DensityOutsideBoneIsBelowTheIsovalue) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3(0, 0, -1), Vec3::UnitZ()));
  EXPECT_LT(densest_point(bone, kShaft, Pose{}, Vec3(0, 0, 0)).density, bone.isovalue());
  EXPECT_EQ(count_in_bone(bone, kShaft, Pose{}), 0);
}

TEST(ShaftProbe, CountsTheVerticesInBone) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3(0, 0, 2.5), -Vec3::UnitZ()));
  EXPECT_EQ(count_in_bone(bone, kShaft, Pose{}), 2);
}

}  // namespace
}  // namespace osteomill::line_proxy
