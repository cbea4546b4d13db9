#include "osteomill/haptics/burr_presses.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/shapes.h"

namespace osteomill {
namespace {

using testing_support::centred_cube;
using testing_support::shape_volume;

constexpr double kVoxel_mm = 0.25;

// Bone below z = 0 and beyond x = 2.
Volume floor_and_wall() {
  return shape_volume(centred_cube(48, kVoxel_mm),
                      [](const Vec3& point_W) { return std::min(point_W.z(), 2 - point_W.x()); });
}

TEST(BurrPresses, OnWhatLiesAheadOfItWithinReach) {
  const Volume bone = floor_and_wall();
  constexpr double r = 1.5;
  const auto presses = [&](const Vec3& burr_W, const Vec3& force_N) {
    return burr_presses(bone, r, burr_W, force_N);
  };
  const Vec3 down(0, 0, -2), aside(0.1, 0, 0);
  const double reach_mm = pressing_reach_mm(bone.geometry());
  EXPECT_TRUE(presses({-2, 0, r + 0.8 * reach_mm}, down));
  EXPECT_FALSE(presses({-2, 0, r + 1.2 * reach_mm}, down));
  EXPECT_FALSE(presses({-2, 0, r + 0.1 * kVoxel_mm}, -down)) << "away from it";
  // Against the wall, and high above the floor.
  const Vec3 at_wall_W(2 - r, 0, 3);
  EXPECT_TRUE(presses(at_wall_W, aside));
  EXPECT_FALSE(presses(at_wall_W, down)) << "along the wall";
  EXPECT_FALSE(presses({-2, 0, r}, Vec3::Zero()));
}

TEST(PressingBurr, CountsForAsLongAgainAsBoneWasAheadButNotForLong) {
  const Volume bone = floor_and_wall();
  const auto counts_after = [&](int pressed_ticks) {
    PressingBurr burr;
    const auto presses = [&](double height_mm) {
      return burr.presses(bone, 1.5, {-2, 0, 1.5 + height_mm}, {0, 0, -2}, 1e-3);
    };
    for (int n = 0; n < pressed_ticks; ++n) EXPECT_TRUE(presses(0.1));
    int ticks = 0;
    while (ticks < 100 && presses(1)) ++ticks;
    return ticks;
  };
  EXPECT_EQ(counts_after(0), 0);
  EXPECT_NEAR(counts_after(4), 4, 1);
  EXPECT_NEAR(counts_after(50), 1e3 * kPressingKept_s, 1);
}

}  // namespace
}  // namespace osteomill
