#include "osteomill/haptics/burr_presses.h"

#include <algorithm>

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::shape_volume;

constexpr double kVoxel_mm = 0.25;
const Quat kTurned = Quat(0.8, 0.3, -0.4, 0.33).normalized();

// Bone below z = 0 and beyond x = 2.
Volume floor_and_wall() {
  return shape_volume(centred_cube(48, kVoxel_mm),
                      [](const Vec3& point_W) { return std::min(point_W.z(), 2 - point_W.x()); });
}

TEST(BurrPresses, OnWhatLiesAheadOfItWithinAVoxel) {
  const Volume bone = floor_and_wall();
  const MillingTool tool;
  const double r = tool.burr_radius_mm;
  for (const Quat& turn : {Quat(Quat::Identity()), kTurned}) {
    const auto presses = [&](const Vec3& burr_W, const Vec3& force_N) {
      return burr_presses(bone, tool, {burr_W, turn}, force_N);
    };
    const Vec3 down(0, 0, -2), aside(0.1, 0, 0);
    EXPECT_TRUE(presses({-2, 0, r + 0.8 * kVoxel_mm}, down));
    EXPECT_FALSE(presses({-2, 0, r + 1.2 * kVoxel_mm}, down));
    EXPECT_FALSE(presses({-2, 0, r + 0.1 * kVoxel_mm}, -down)) << "away from it";
    // Against the wall, and high above the floor.
    const Vec3 at_wall_W(2 - r, 0, 3);
    EXPECT_TRUE(presses(at_wall_W, aside));
    EXPECT_FALSE(presses(at_wall_W, down)) << "along the wall";
  }
}

}  // namespace
}  // namespace osteomill
