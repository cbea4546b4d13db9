#include "bone_points/brick_points.h"

#include <gtest/gtest.h>

namespace osteomill {
namespace {

// An exhausted pool drops points and counts them; they are stored again once there is space.
TEST(BrickPoints, DropsAndCountsPointsBeyondThePoolUntilItIsFreed) {
  BrickPoints pool(2, 2);
  const ShellPoint one{1, 2, 3, 4};
  PointRows many(100), some(100);
  for (int n = 0; n < 100; ++n) many.add(one);
  for (int n = 0; n < 40; ++n) some.add(one);
  EXPECT_EQ(pool.replace(0, many), 64u);
  EXPECT_EQ(pool.dropped(), 36u);
  EXPECT_EQ(pool.replace(1, many), 0u);
  EXPECT_EQ(pool.replace(0, PointRows{}), 0u);
  EXPECT_EQ(pool.replace(1, some), 40u);
  int stored = 0;
  pool.for_each_of(1, [&](const ShellPoint& point) { stored += point == one ? 1 : 0; });
  EXPECT_EQ(stored, 40);
}

}  // namespace
}  // namespace osteomill
