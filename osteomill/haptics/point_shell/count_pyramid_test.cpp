#include "osteomill/haptics/point_shell/count_pyramid.h"

#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

using Node = std::array<int, 3>;

std::vector<Node> visited(const CountPyramid& pyramid) {
  std::vector<Node> leaves;
  pyramid.visit([](int, int, int, int) { return false; },
                [&](int i, int j, int k) {
                  leaves.push_back({i, j, k});
                });
  return leaves;
}

TEST(CountPyramid, AVisitFindsExactlyTheBricksWithPoints) {
  CountPyramid pyramid({5, 3, 9});
  pyramid.add(4, 2, 8, 7);
  pyramid.add(0, 0, 0, 1);
  pyramid.add(3, 1, 2, 2);
  EXPECT_EQ(pyramid.total(), 10u);
  EXPECT_EQ(visited(pyramid).size(), 3u);
  pyramid.add(3, 1, 2, -2);
  EXPECT_EQ(visited(pyramid), (std::vector<Node>{{0, 0, 0}, {4, 2, 8}}));
  EXPECT_EQ(pyramid.count(0, 3, 1, 2), 0u);
  EXPECT_EQ(pyramid.total(), 8u);
}

TEST(CountPyramid, ARejectedNodeIsNotEntered) {
  CountPyramid pyramid({8, 8, 8});
  pyramid.add(1, 1, 1, 1);
  pyramid.add(7, 7, 7, 1);
  std::vector<Node> leaves;
  pyramid.visit([](int level, int i, int, int) { return level == 2 && i == 0; },
                [&](int i, int j, int k) {
                  leaves.push_back({i, j, k});
                });
  EXPECT_EQ(leaves, (std::vector<Node>{{7, 7, 7}}));
}

TEST(CountPyramid, OneBrickIsItsOwnRoot) {
  CountPyramid pyramid({1, 1, 1});
  EXPECT_EQ(pyramid.level_count(), 1);
  EXPECT_TRUE(visited(pyramid).empty());
  pyramid.add(0, 0, 0, 3);
  EXPECT_EQ(visited(pyramid).size(), 1u);
}

}  // namespace
}  // namespace osteomill
