#include "osteomill/live/milled_copy.h"

#include "tests/shapes.h"
#include <gtest/gtest.h>

namespace osteomill {
namespace {

// 20 voxels a side: the bricks at the upper sides reach beyond the grid.
class MilledCopyTest : public ::testing::Test {
 protected:
  // Lowers one voxel of the bone and hands the change over.
  void mill(const VoxelIndex& voxel) {
    bone_.lower_density(voxel, bone_.grid()[voxel] - 100);
    DensityHandover handover(bone_.geometry(), 8);
    handover.mark({{voxel, voxel}});
    handover.send(bone_, 8);
    while (const DensityHandover::Brick* brick = handover.front()) {
      copy_.put(*brick);
      handover.pop();
    }
  }
  const std::vector<float>& now() const { return copy_.grid().densities(); }

  Volume bone_ = testing_support::shape_volume(testing_support::centred_cube(20, 0.25),
                                               testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const std::vector<float> before_ = bone_.grid().densities();
  MilledCopy copy_{bone_.grid()};
};

TEST_F(MilledCopyTest, FollowsTheBone) {
  EXPECT_FALSE(copy_.touched());
  mill({3, 4, 5});
  mill({19, 19, 19});
  EXPECT_EQ(now(), bone_.grid().densities());
  EXPECT_TRUE(copy_.touched());
}

TEST_F(MilledCopyTest, TakesCutsBackOneByOne) {
  EXPECT_EQ(copy_.cuts(), 0u);
  copy_.begin_cut(0);
  mill({3, 4, 5});
  mill({3, 4, 6});
  copy_.begin_cut(2.5);
  const std::vector<float> after_first = now();
  mill({3, 4, 5});
  mill({18, 2, 9});
  EXPECT_EQ(copy_.cuts(), 2u);
  EXPECT_EQ(copy_.undo(), 2.5);
  EXPECT_EQ(now(), after_first);
  EXPECT_EQ(copy_.cuts(), 1u);
  EXPECT_EQ(copy_.undo(), 0);
  EXPECT_EQ(now(), before_);
  EXPECT_EQ(copy_.cuts(), 0u);
  EXPECT_EQ(copy_.undo(), 0);
}

TEST_F(MilledCopyTest, ACutWithoutAChangeIsNone) {
  copy_.begin_cut(0);
  copy_.begin_cut(0);
  mill({3, 4, 5});
  copy_.begin_cut(1);
  copy_.begin_cut(1);
  EXPECT_EQ(copy_.cuts(), 1u);
  EXPECT_EQ(copy_.undo(), 0);
  EXPECT_EQ(now(), before_);
}

TEST_F(MilledCopyTest, ResetsPastEveryCut) {
  for (int n = 0; n < 5; ++n) {
    copy_.begin_cut(n);
    mill({n, 4, 5});
  }
  copy_.undo();
  copy_.reset();
  EXPECT_EQ(now(), before_);
  EXPECT_EQ(copy_.cuts(), 0u);
  EXPECT_FALSE(copy_.touched());
}

TEST_F(MilledCopyTest, ForgetsTheOldestCutsBeyondItsMemory) {
  copy_ = MilledCopy(bone_.grid(), 2 * 2048);
  for (int n = 0; n < 5; ++n) {
    copy_.begin_cut(n);
    mill({n, 4, 5});
  }
  EXPECT_EQ(copy_.cuts(), 2u);
  EXPECT_EQ(copy_.undo(), 4);
  EXPECT_EQ(copy_.undo(), 3);
  EXPECT_EQ(copy_.cuts(), 0u);
  copy_.reset();
  EXPECT_EQ(now(), before_);
}

}  // namespace
}  // namespace osteomill
