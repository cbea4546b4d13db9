#include "osteomill/session/milling_entry.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/volume/isovalue.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

const MillingTool kTool;

std::string reason_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PlaceEntry, DefaultsToTheTopOfTheBoneDownwards) {
  const Volume volume = shape_volume(centred_cube(60, 0.5), ball({1, -2, 3}, 8));
  const MillingEntry entry = place_entry(volume, kTool);
  EXPECT_LT((entry.point_W - Vec3(1, -2, 11)).norm(), 0.05) << entry.point_W.transpose();
  EXPECT_EQ(entry.direction_W, Vec3(0, 0, -1));
  EXPECT_NEAR(entry.lateral_W.norm(), 1, 1e-12);
  EXPECT_NEAR(entry.lateral_W.dot(entry.direction_W), 0, 1e-12);
}

TEST(PlaceEntry, DirectionAloneEntersAtTheFirstBoneAlongIt) {
  const Volume volume = shape_volume(centred_cube(60, 0.5), ball({1, -2, 3}, 8));
  const Vec3 direction = Vec3(3, 0, -4);
  const MillingEntry entry = place_entry(volume, kTool, std::nullopt, direction);
  EXPECT_LT((entry.point_W - (Vec3(1, -2, 3) - 8 * direction / 5)).norm(), 0.3);
  EXPECT_NEAR((entry.point_W - Vec3(1, -2, 3)).norm(), 8, 0.05);
  EXPECT_TRUE(entry.direction_W.isApprox(direction / 5, 1e-12));
}

TEST(PlaceEntry, ProjectsAGivenPointOntoTheSurfaceAlongTheDirection) {
  const Volume volume = shape_volume(centred_cube(60, 0.5), ball(Vec3::Zero(), 8));
  const Vec3 direction(-1, 0, 0);
  const double height = std::sqrt(64.0 - 4.0 - 1.0);  // of the ball over y = 2, z = -1
  for (double x : {height + 3, height, 2.0, 5000.0, 1e12}) {
    const MillingEntry entry = place_entry(volume, kTool, Vec3(x, 2, -1), direction);
    EXPECT_NEAR(entry.point_W.x(), height, x > 1e9 ? 0.1 : 0.02) << x;
    EXPECT_NEAR(entry.point_W.y(), 2, 1e-9);
    EXPECT_NEAR(entry.point_W.z(), -1, 1e-9);
  }
}

TEST(PlaceEntry, LateralDirectionPointsToTheHighestRim) {
  // Bone that rises towards +y: the shaft is to be leant against that side.
  const Volume slope = shape_volume(centred_cube(60, 0.5), plane({0, 0, 0}, {0, -0.4, 1}));
  const MillingEntry entry = place_entry(slope, kTool, Vec3(0, 0, 4), Vec3(0, 0, -1));
  EXPECT_GT(entry.lateral_W.y(), std::cos(0.2));
}

TEST(PlaceEntry, EntersARingNearItsHighestPoint) {
  // A ring about z: a line down through its centre meets no bone.
  const auto ring = [](const Vec3& p) {
    return std::hypot(std::hypot(p.x(), p.y()) - 6, p.z() - 0.05 * p.x()) - 2;
  };
  const Volume volume = shape_volume(centred_cube(60, 0.5), ring);
  const MillingEntry entry = place_entry(volume, kTool);
  EXPECT_NEAR(std::hypot(entry.point_W.x(), entry.point_W.y()), 6, 0.5);
  EXPECT_GT(entry.point_W.z(), 2.0);
}

TEST(PlaceEntry, EntersThePitIfTheBurrFitsAndTheRimOtherwise) {
  const auto pit = [](const Vec3& p) {
    return std::max(p.z() - 8, std::min(2.2 - std::hypot(p.x(), p.y()), 1.0 + p.z() - 4.2));
  };
  const auto narrow_tube = [&](const Vec3& p) { return std::max(pit(p), std::hypot(p.x(), p.y()) - 5); };
  const Volume volume = shape_volume(centred_cube(60, 0.5), narrow_tube);
  // The pit is 4.4 mm wide and 5 mm deep: the default burr fits, a 6 mm burr does not.
  EXPECT_LT(place_entry(volume, kTool).point_W.z(), 4.0);
  EXPECT_GT(place_entry(volume, {3.0, 1.0, 25.0}).point_W.z(), 7.4);
}

TEST(PlaceEntry, ReportsTheReasonIfThereIsNoEntry) {
  const Volume empty = shape_volume(centred_cube(20, 1.0), [](const Vec3&) { return 100.0; });
  EXPECT_EQ(
      reason_of([&] { place_entry(empty, kTool, {}, {}, "knee.nrrd"); }),
      "knee.nrrd: has no bone to mill: no voxel is denser than the isovalue, 500, and the densest has 0");
  const Volume volume = shape_volume(centred_cube(60, 0.5), ball(Vec3::Zero(), 8));
  EXPECT_NE(reason_of([&] { place_entry(volume, kTool, Vec3(12, 0, 0)); }).find("meets no bone"),
            std::string::npos);
  EXPECT_NE(reason_of([&] { place_entry(volume, kTool, Vec3(0, 0, -12)); }).find("meets no bone"),
            std::string::npos);
  EXPECT_NE(reason_of([&] { place_entry(volume, kTool, Vec3(0, 0, 12), Vec3::Zero()); }).find("direction: "),
            std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(reason_of([&] { place_entry(volume, kTool, Vec3(0, nan, 12)); }).find("entry: "),
            std::string::npos);
  EXPECT_NE(reason_of([&] { place_entry(volume, kTool, std::nullopt, Vec3(0, nan, 1)); }).find("direction: "),
            std::string::npos);
}

TEST(PlaceEntry, RefusesAnEntryIfBoneIsInTheWayOfTheTool) {
  // Two balls, one above the other; the entry is between them, and the upper one blocks the tool.
  const auto two = [](const Vec3& p) {
    return std::min((p - Vec3(0, 0, 8)).norm(), (p + Vec3(0, 0, 8)).norm()) - 5;
  };
  const Volume volume = shape_volume(centred_cube(60, 0.5), two);
  EXPECT_NE(reason_of([&] { place_entry(volume, kTool, Vec3(0, 0, 0)); }).find("in the way"),
            std::string::npos);
  EXPECT_NO_THROW(place_entry(volume, kTool, Vec3(-12, 0, -8), Vec3(1, 0, 0)));
}

// Rotating scan and direction must rotate the entry.
TEST(PlaceEntry, RotatingTheScanRotatesTheEntryPoint) {
  GridGeometry turned = centred_cube(60, 0.5);
  const Quat turn = quaternion_from_rotation_vector({0.5, -0.3, 0.9});
  turned.origin_mm = turn * turned.origin_mm;
  turned.direction = turn.toRotationMatrix();
  const auto egg = [](const Vec3& p) {
    return (p.cwiseQuotient(Vec3(1, 0.6, 0.8)) - Vec3(1, 2, 0)).norm() - 8;
  };
  const Volume plain_volume = shape_volume(centred_cube(60, 0.5), egg);
  const Volume turned_volume = shape_volume(turned, [&](const Vec3& p) { return egg(turn.conjugate() * p); });
  const MillingEntry plain = place_entry(plain_volume, kTool);
  const MillingEntry other = place_entry(turned_volume, kTool, std::nullopt, turn * Vec3(0, 0, -1));
  EXPECT_LT((turn * plain.point_W - other.point_W).norm(), 1e-3);
}

TEST(PlaceEntry, PoseAboveHasTheGivenClearanceAndShaftDirection) {
  const MillingEntry entry{{1, 2, 3}, {0, 0, 1}, {1, 0, 0}};
  const Pose pose = pose_above(entry, kTool, 3.0);
  EXPECT_TRUE(pose.position_mm.isApprox(Vec3(1, 2, 3 - 4.5), 1e-12));
  EXPECT_TRUE(shaft_direction(pose).isApprox(Vec3(0, 0, -1), 1e-12));
}

// A skull vault whose top is outside the scan: the highest voxels are on the cut edge of a wall.
TEST(PlaceEntry, AvoidsBoneCutOffByTheVolumeUnlessGivenExplicitly) {
  const auto vault = [](const Vec3& p) { return std::abs(p.norm() - 20) - 3; };
  GridGeometry geometry = centred_cube(60, 1);
  geometry.dims[2] = 42;
  const Volume volume = shape_volume(geometry, vault);
  EXPECT_EQ(isovalue_warnings(volume.grid(), volume.isovalue()).size(), 1u);
  const MillingEntry entry = place_entry(volume, kTool);
  EXPECT_TRUE(entry_warnings(volume, kTool, entry).empty());
  EXPECT_NEAR(entry.point_W.norm(), 23, 0.5) << "outside, not in the hollow";
  EXPECT_GT(-entry.direction_W.dot(entry.point_W.normalized()), 0.4);
  // If given explicitly, the edge is used, with a warning.
  const MillingEntry edge = place_entry(volume, kTool, Vec3(17, 0, 30), Vec3(0, 0, -1));
  ASSERT_EQ(entry_warnings(volume, kTool, edge).size(), 1u);
  EXPECT_NE(entry_warnings(volume, kTool, edge).front().find("cuts the bone off"), std::string::npos);
}

TEST(PlaceEntry, SkipsAThinFinForTheBlockBelowIt) {
  // A fin on a block: the fin is the top.
  const auto finned = [](const Vec3& p) {
    const double block = std::max({std::abs(p.x()) - 12, std::abs(p.y()) - 12, p.z()});
    const double fin = std::max({std::abs(p.x() - 8) - 0.5, std::abs(p.y()) - 6, std::abs(p.z() - 3) - 4});
    return std::min(block, fin);
  };
  const Volume volume = shape_volume(centred_cube(60, 0.5), finned);
  const MillingEntry entry = place_entry(volume, kTool);
  EXPECT_NEAR(entry.point_W.z(), 0, 0.1);
  EXPECT_TRUE(entry_warnings(volume, kTool, entry).empty());
}

TEST(PlaceEntry, WarnsOfSlicesThickerThanTheBurrRadius) {
  GridGeometry geometry = centred_cube(40, 0.5);
  geometry.spacing_mm.z() = 3;
  geometry.origin_mm.z() = -58.5;
  const Volume volume = shape_volume(geometry, plane(Vec3::Zero(), Vec3::UnitZ()));
  MillingTool tool = kTool;
  for (const double radius_mm : {2.9, 3.1}) {
    tool.burr_radius_mm = radius_mm;
    EXPECT_EQ(entry_warnings(volume, tool, place_entry(volume, tool)).size(), radius_mm < 3 ? 1u : 0u);
  }
}

TEST(PlaceEntry, WarnsIfThereIsNoGoodEntry) {
  // A lattice of thin rods.
  const auto rods = [](const Vec3& p) {
    const auto off = [](double x) { return std::abs(x - 4 * std::round(x / 4)); };
    return std::hypot(off(p.x()), off(p.y())) - 0.5;
  };
  const Volume volume = shape_volume(centred_cube(48, 0.25), rods);
  const MillingEntry entry = place_entry(volume, kTool, std::nullopt, Vec3(0, 0, -1));
  EXPECT_EQ(entry_warnings(volume, kTool, entry).size(), 1u);
}

}  // namespace
}  // namespace osteomill
