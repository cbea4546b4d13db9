#include "osteomill/haptics/bone_points/brick_points.h"

#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

// A grid of single voxels asks for more points than there is room for only where the pool is too small; then
// points are dropped, counted, and taken in again once there is room.
TEST(BrickPoints, APoolThatRunsOutDropsPointsAndSaysSo) {
  BrickPoints pool(2, 2);
  const std::vector<ShellPoint> many(100, ShellPoint{1, 2, 3, 4});
  EXPECT_EQ(pool.replace(0, many), 64u);
  EXPECT_EQ(pool.dropped(), 36u);
  EXPECT_EQ(pool.replace(1, many), 0u);
  EXPECT_EQ(pool.replace(0, {}), 0u);
  EXPECT_EQ(pool.replace(1, {many.data(), 40}), 40u);
  int stored = 0;
  pool.for_each_of(1, [&](const ShellPoint& point) { stored += point == many[0] ? 1 : 0; });
  EXPECT_EQ(stored, 40);
}

}  // namespace
}  // namespace osteomill
