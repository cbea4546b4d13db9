#include "osteomill/haptics/surface_points/held_tool.h"

#include <numbers>

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill::surface_points {
namespace {

using testing_support::ball;
using testing_support::centred_cube;
using testing_support::plane;
using testing_support::shape_volume;

const MillingTool kTool{1.5, 1.0, 25.0};

HeldTool held_at(const Volume& volume, const Pose& X) {
  HeldTool held;
  held.prepare(volume, kTool, 40, 0.0);
  held.follow(X);
  return held;
}

TEST(HeldTool, InFreeSpaceItIsTheDevice) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  HeldTool held = held_at(volume, {{0, 0, 3}, Quat::Identity()});
  const Pose X{{0.3, -0.1, 3.4}, quaternion_from_rotation_vector({0.02, 0.01, 0})};
  const Pose& result = held.follow(X);
  EXPECT_EQ(result.position_mm, X.position_mm);
  EXPECT_EQ(result.orientation.coeffs(), X.orientation.coeffs());
}

// On a plane the nearest allowed pose is the device's foot on it, a radius above, whatever the device's
// depth.
TEST(HeldTool, OnAPlaneItRestsAboveTheDeviceWithoutFriction) {
  const Vec3 normal = Vec3(0.3, 0.2, 1).normalized();
  const Volume volume = shape_volume(centred_cube(64, 0.25), plane(Vec3::Zero(), normal));
  const Quat upright = smallest_rotation(Vec3::UnitZ(), normal);
  HeldTool held = held_at(volume, {2.0 * normal, upright});
  const Vec3 along = normal.cross(Vec3::UnitX()).normalized();
  for (int n = 0; n < 200; ++n) {
    const double height = 2.0 - 0.03 * std::min(n, 100);
    const Vec3 foot = 0.02 * n * along;
    const Pose& result = held.follow({foot + height * normal, upright});
    const Vec3 expected = foot + std::max(height, 1.5) * normal;
    // The normals taken from the density err by up to 2 degrees.
    const double overlap = std::max(0.0, 1.5 - height);
    EXPECT_LT((result.position_mm - expected).norm(), 0.01 + 0.035 * overlap) << n;
  }
}

TEST(HeldTool, ItStaysOnABallThatTheDeviceDivesInto) {
  const Volume volume = shape_volume(centred_cube(80, 0.25), ball(Vec3::Zero(), 5.0));
  const Vec3 direction = Vec3(0.2, -0.3, 1).normalized();
  const Quat upright = smallest_rotation(Vec3::UnitZ(), direction);
  HeldTool held = held_at(volume, {7.0 * direction, upright});
  for (int n = 0; n < 60; ++n) {
    const Pose& result = held.follow({(7.0 - 0.1 * n) * direction, upright});
    EXPECT_GT(result.position_mm.norm(), 6.5 - 0.05) << n;
  }
}

// A wall thinner than the burr, and a device that jumps clean through it.
TEST(HeldTool, AThinWallHoldsIt) {
  const Volume volume =
      shape_volume(centred_cube(80, 0.25), [](const Vec3& p) { return std::abs(p.z()) - 0.3; });
  HeldTool held = held_at(volume, {{0, 0, 2}, Quat::Identity()});
  for (int n = 0; n < 30; ++n) held.follow({{0, 0, -4}, Quat::Identity()});
  EXPECT_NEAR(held.follow({{0, 0, -4}, Quat::Identity()}).position_mm.z(), 1.8, 0.05);
}

TEST(HeldTool, TheShaftIsHeldToo) {
  const Volume volume = shape_volume(centred_cube(64, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  const Quat lying = quaternion_from_rotation_vector({0, std::numbers::pi / 2, 0});
  // The burr hangs out beyond the bone's side; only the shaft is above it.
  HeldTool held = held_at(volume, {{-11, 0, 1.5}, lying});
  for (int n = 0; n < 40; ++n) held.follow({{-11, 0, 1.5 - 0.05 * n}, lying});
  const Pose result = held.follow({{-11, 0, -0.5}, lying});
  for (const double z : {5.0, 10.0, 15.0}) EXPECT_GT((result * Vec3(0, 0, z)).z(), 1.0 - 0.03) << z;
}

// The shaft's flat end goes ahead, straight on and at a slant.
TEST(HeldTool, TheShaftsEndIsHeldToo) {
  const Volume volume = shape_volume(centred_cube(48, 0.25), plane(Vec3::Zero(), Vec3::UnitZ()));
  for (const double tilt : {0.0, 0.5}) {
    const Quat upside_down = quaternion_from_rotation_vector({std::numbers::pi - tilt, 0, 0});
    const Vec3 end_T(0, 0, kTool.shaft_length_mm);
    const Vec3 start = Vec3(0, 0, 1.5) - upside_down * end_T;
    HeldTool held = held_at(volume, {start, upside_down});
    Pose result;
    for (int n = 0; n < 100; ++n) result = held.follow({start - Vec3(0, 0, 0.05 * n), upside_down});
    EXPECT_GT((result * end_T).z(), -0.1) << tilt;
  }
}

}  // namespace
}  // namespace osteomill::surface_points
