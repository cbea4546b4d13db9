#include "osteomill/haptics/line_proxy/shaft_probe.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill::line_proxy {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

const std::vector<Vec3> kShaft{{0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}};

TEST(ShaftProbe, TheDeepestOfAnEdgeIsTheDensest) {
  // The axis runs past the middle of a small ball, which is densest nearest to it: 2.75 up the shaft, between
  // two vertices but on a sub-step of the one at 3.
  const Volume bone = shape_volume(centred_cube(48, 0.25), ball(Vec3(0, 0.9, 2.75), 1.0), 4.0);
  const ShaftProbe probe = densest_point(bone, kShaft, Pose{}, Vec3(0, 0, 3));
  EXPECT_LT((probe.point_W - Vec3(0, 0, 2.75)).norm(), 1e-9);
  EXPECT_GT(probe.density, bone.isovalue());
}

TEST(ShaftProbe, AmongEquallyDensePointsItIsTheMiddleOfTheRun) {
  // Saturated from z = 1.5 on: of the sub-steps of a quarter, from 1.5 to 4.
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3(0, 0, 1.125), -Vec3::UnitZ()));
  const ShaftProbe probe = densest_point(bone, kShaft, Pose{}, Vec3(0, 0, 3));
  EXPECT_NEAR(probe.point_W.z(), 2.75, 1e-9);
}

TEST(ShaftProbe, OutsideTheBoneTheDensityIsBelowTheIsovalue) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3(0, 0, -1), Vec3::UnitZ()));
  EXPECT_LT(densest_point(bone, kShaft, Pose{}, Vec3(0, 0, 0)).density, bone.isovalue());
  EXPECT_EQ(vertices_in_bone(bone, kShaft, Pose{}), 0);
}

// Bone from 1.6 to 2.9 and from 3.4 on.
Volume two_pieces() {
  return shape_volume(centred_cube(96, 0.125),
                      [](const Vec3& p) { return std::min(std::abs(p.z() - 2.25) - 0.65, 3.4 - p.z()); });
}

TEST(ShaftProbe, TheNearestRunOfBoneIsFound) {
  const Volume bone = two_pieces();
  const auto low = nearest_run(bone, kShaft, Pose{}, Vec3(0, 0, 0));
  ASSERT_TRUE(low);
  EXPECT_EQ(sample_W(kShaft, Pose{}, low->first).z(), 1.75);
  EXPECT_EQ(sample_W(kShaft, Pose{}, low->last).z(), 2.75);
  const auto high = nearest_run(bone, kShaft, Pose{}, Vec3(0, 0, 3.3));
  ASSERT_TRUE(high);
  EXPECT_EQ(sample_W(kShaft, Pose{}, high->first).z(), 3.5);
  EXPECT_EQ(sample_W(kShaft, Pose{}, high->last).z(), 4.0);
  EXPECT_FALSE(nearest_run(bone, kShaft, Pose{Vec3(0, 0, -4), Quat::Identity()}, Vec3(0, 0, 0)));
}

TEST(ShaftProbe, TheMiddleOfARunMovesLittleWhenTheSamplesDo) {
  const Volume bone = two_pieces();
  for (double shift = 0; shift < 0.25; shift += 0.03) {
    const Pose X_WT{Vec3(0, 0, shift), Quat::Identity()};
    const auto run = nearest_run(bone, kShaft, X_WT, Vec3(0, 0, 2));
    ASSERT_TRUE(run);
    EXPECT_NEAR(sample_W(kShaft, X_WT, middle_of(bone, kShaft, X_WT, *run)).z(), 2.25, 0.06) << shift;
  }
}

// A ridge across the shaft, its crest at z = 2.6: the shaft must be moved furthest there, although the middle
// of what is in bone (1.6 to 3.1) lies lower and the bone is everywhere as dense.
TEST(ShaftProbe, DeepestAcrossIsTheCrestOfARidge) {
  const Volume bone = shape_volume(centred_cube(96, 0.125), [](const Vec3& p) {
    return std::max((p.x() - 0.5 - 0.5 * (p.z() - 2.6)) / std::hypot(1, 0.5),
                    (p.x() - 0.5 + (p.z() - 2.6)) / std::hypot(1, 1));
  });
  const auto run = nearest_run(bone, kShaft, Pose{}, Vec3(0, 0, 2));
  ASSERT_TRUE(run);
  const double middle = middle_of(bone, kShaft, Pose{}, *run);
  EXPECT_LT(sample_W(kShaft, Pose{}, middle).z(), 2.45);
  const auto crest = deepest_across(bone, kShaft, Pose{}, *run, middle, Vec3::UnitX(), 2.0);
  ASSERT_TRUE(crest);
  EXPECT_NEAR(crest->z(), 2.6, 0.1);
  EXPECT_NEAR(crest->x(), 0.5, 0.08);
  EXPECT_FALSE(deepest_across(bone, kShaft, Pose{}, *run, middle, -Vec3::UnitX(), 2.0));
}

TEST(ShaftProbe, VerticesInBoneAreCounted) {
  const Volume bone = shape_volume(centred_cube(48, 0.25), plane(Vec3(0, 0, 2.5), -Vec3::UnitZ()));
  EXPECT_EQ(vertices_in_bone(bone, kShaft, Pose{}), 2);
}

}  // namespace
}  // namespace osteomill::line_proxy
