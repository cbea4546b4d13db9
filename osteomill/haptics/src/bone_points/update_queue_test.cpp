#include "bone_points/update_queue.h"

#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

TEST(UpdateQueue, ReturnsEachBrickOnceAndLaterAdditionsLast) {
  UpdateQueue queue;
  EXPECT_FALSE(queue.next());
  queue.add({{1, 1, 1}, {2, 2, 1}});
  EXPECT_EQ(queue.size(), 4u);
  EXPECT_EQ(queue.next(), (VoxelIndex{1, 1, 1}));
  queue.add({{5, 5, 5}, {5, 5, 5}});
  queue.add({});
  EXPECT_EQ(queue.size(), 4u);
  std::vector<VoxelIndex> taken;
  while (const auto brick = queue.next()) taken.push_back(*brick);
  EXPECT_EQ(taken, std::vector<VoxelIndex>({{2, 1, 1}, {1, 2, 1}, {2, 2, 1}, {5, 5, 5}}));
  EXPECT_TRUE(queue.is_empty());
  EXPECT_EQ(queue.size(), 0u);
}

TEST(UpdateQueue, LightlyLoadedBricksTakeTurnsWhenOverBudget) {
  UpdateQueue queue;
  for (std::uint32_t slot = 0; slot < 8; ++slot) queue.add_supporting(slot, 0.001f);
  std::vector<int> turns(9);
  const auto take = [&](int cost) {
    queue.update_supporting_in_turns([&](std::uint32_t) { return cost; },
                                     [&](std::uint32_t slot) { ++turns[slot]; });
  };
  // A brick that bears nearly all of the load is updated at every call.
  queue.add_supporting(8, 1);
  take(UpdateQueue::kSupportingPointsPerMs / 16);
  EXPECT_EQ(turns, std::vector<int>(9, 1));
  EXPECT_EQ(queue.size(), 0u);
  for (int tick = 0; tick < 3; ++tick) {
    take(2 * UpdateQueue::kSupportingPointsPerMs / 9 + 1);
    EXPECT_GE(queue.size(), 5u);
  }
  EXPECT_EQ(turns, std::vector<int>({2, 2, 2, 2, 2, 2, 2, 2, 4}));
  // A brick that costs more than a tick's budget takes turns like the others.
  const int dear = UpdateQueue::kSupportingPointsPerMs + 1;
  const int before = turns[8];
  for (int tick = 0; tick < 4; ++tick) take(dear);
  EXPECT_LT(turns[8], before + 4);
  for (std::size_t n = 0; n < 2 * UpdateQueue::kMaxSupporting; ++n) queue.add_supporting(0, 1);
  queue.clear_supporting();
  take(1);
  EXPECT_EQ(queue.size(), 0u);
}

TEST(UpdateQueue, UpdatesTheMostLoadedBricksAtEveryCallIfAllExceedTheBudget) {
  UpdateQueue queue;
  std::vector<int> turns(8);
  // Loads of 1, 2, 4, ... of 255 in total; each brick costs a third of a tick's points.
  for (std::uint32_t slot = 0; slot < 8; ++slot) queue.add_supporting(slot, static_cast<float>(1 << slot));
  constexpr int kTicks = 12;
  for (int tick = 0; tick < kTicks; ++tick) {
    queue.update_supporting_in_turns([](std::uint32_t) { return UpdateQueue::kSupportingPointsPerMs / 3; },
                                     [&](std::uint32_t slot) { ++turns[slot]; });
  }
  EXPECT_EQ(turns, std::vector<int>({4, 4, 4, 4, 4, kTicks, kTicks, kTicks}));
}

TEST(UpdateQueue, BudgetsScaleWithTheTickLength) {
  UpdateQueue queue(0.25e-3);
  for (std::uint32_t slot = 0; slot < 8; ++slot) queue.add_supporting(slot, 1);
  int uses = 0;
  for (int tick = 0; tick < 8; ++tick) {
    queue.update_supporting_in_turns([](std::uint32_t) { return UpdateQueue::kSupportingPointsPerMs / 8; },
                                     [&](std::uint32_t) { ++uses; });
  }
  // Eight bricks take four turns; a tick of 1 ms would update them all.
  EXPECT_EQ(uses, 2 * 8);
  queue.begin_tick();
  queue.spend_build_budget(UpdateQueue::kBuiltPointsPerMs / 4);
  EXPECT_FALSE(queue.has_build_budget());
}

TEST(UpdateQueue, BeginTickResetsTheBudgetAndReportsPendingBricks) {
  UpdateQueue queue;
  queue.spend_build_budget(1000000);
  EXPECT_TRUE(queue.has_build_budget());
  EXPECT_FALSE(queue.begin_tick());
  queue.spend_build_budget(UpdateQueue::kBuiltPointsPerMs);
  EXPECT_FALSE(queue.has_build_budget());
  queue.add({{0, 0, 0}, {1, 0, 0}});
  EXPECT_FALSE(queue.begin_tick());
  EXPECT_TRUE(queue.has_build_budget());
  EXPECT_TRUE(queue.begin_tick());
}

}  // namespace
}  // namespace osteomill
