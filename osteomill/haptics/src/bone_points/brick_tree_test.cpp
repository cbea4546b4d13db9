#include "bone_points/brick_tree.h"

#include <vector>

#include <gtest/gtest.h>

namespace osteomill {
namespace {

BrickTree::EightBits everywhere(int, const VoxelIndex&) {
  return 0xff;
}

// Gives every entry above the bricks a node.
void open_all(BrickTree& tree) {
  tree.visit(everywhere, [&](int level, const VoxelIndex&, BrickTree::EntryIndex entry) {
    if (level > 0) tree.add_node(entry);
  });
}

TEST(BrickTree, VisitsOnlyUnknownBricksAndSlotsWithoutChangingThem) {
  BrickTree tree({4, 4, 4});
  open_all(tree);
  tree.set_content(tree.find({1, 2, 3}).first, 7);
  tree.set_content(tree.find({0, 0, 0}).first, BrickTree::kNoBone);
  tree.set_content(tree.find({3, 3, 3}).first, BrickTree::kAllBone);
  for (int repeat = 0; repeat < 2; ++repeat) {
    int unseen = 0;
    std::vector<VoxelIndex> with_slot;
    tree.visit(everywhere, [&](int level, const VoxelIndex& brick, BrickTree::EntryIndex entry) {
      EXPECT_EQ(level, 0);
      if (tree.content(entry) == BrickTree::kUnknown) {
        ++unseen;
      } else {
        EXPECT_EQ(tree.content(entry), 7u);
        with_slot.push_back(brick);
      }
    });
    EXPECT_EQ(unseen, 4 * 4 * 4 - 3);
    EXPECT_EQ(with_slot, std::vector<VoxelIndex>({{1, 2, 3}}));
  }
}

TEST(BrickTree, FindsTheFinestExistingLevel) {
  BrickTree tree({8, 8, 8});
  EXPECT_EQ(tree.find({5, 6, 7}).second, 2);
  tree.add_node(tree.find({5, 6, 7}).first);
  EXPECT_EQ(tree.find({5, 6, 7}).second, 1);
  EXPECT_EQ(tree.find({0, 6, 7}).second, 2);
  tree.add_node(tree.find({5, 6, 7}).first);
  EXPECT_EQ(tree.find({5, 6, 7}).second, 0);
}

TEST(BrickTree, EvictsNodesWithoutSlotsOnceFewAreFree) {
  BrickTree tree({64, 64, 64});
  open_all(tree);
  const auto [kept, level] = tree.find({0, 0, 0});
  ASSERT_EQ(level, 0);
  tree.set_content(kept, 3);
  const auto count_unseen_nodes = [&] {
    int unseen = 0;
    tree.visit(everywhere,
               [&](int of_place, const VoxelIndex&, BrickTree::EntryIndex) { unseen += of_place > 0; });
    return unseen;
  };
  const int before = count_unseen_nodes();
  for (int n = 0; n < 100; ++n) tree.evict_nodes();
  EXPECT_GT(count_unseen_nodes(), before);
  EXPECT_EQ(tree.content(tree.find({0, 0, 0}).first), 3u);
}

}  // namespace
}  // namespace osteomill
