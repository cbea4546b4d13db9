#include "cut_history.h"

#include <gtest/gtest.h>

#include "osteomill/volume/editable_volume.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

// 20 voxels a side: the bricks at the upper sides reach beyond the grid.
class CutHistoryTest : public ::testing::Test {
 protected:
  void mill(const VoxelIndex& voxel) {
    const VoxelIndex first{voxel.i / 8 * 8, voxel.j / 8 * 8, voxel.k / 8 * 8};
    const DensityBlock before(bone_.grid(), first);
    bone_.lower_density(voxel, bone_.grid()[voxel] - 100);
    history_.save(before);
  }
  double undo() {
    const double removed_mm3 = put(history_.state_before_last_cut());
    history_.drop_last();
    return removed_mm3;
  }
  void reset() {
    put(history_.state_before_all_cuts());
    history_.drop_all();
  }
  double put(const CutHistory::PriorState& before) {
    for (auto [place, brick] : before.bricks) EditableVolume(bone_).swap(brick);
    return before.removed_mm3;
  }
  const CopyOnWriteFloats& now() const { return bone_.grid().densities(); }

  Volume bone_ = testing_support::shape_volume(testing_support::centred_cube(20, 0.25),
                                               testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const CopyOnWriteFloats before_ = bone_.grid().densities();
  CutHistory history_{std::size_t{1} << 20};
};

TEST_F(CutHistoryTest, TakesCutsBackOneByOne) {
  EXPECT_EQ(history_.cuts(), 0u);
  history_.begin_cut(0);
  mill({3, 4, 5});
  mill({3, 4, 6});
  history_.begin_cut(2.5);
  const CopyOnWriteFloats after_first = now();
  mill({3, 4, 5});
  mill({18, 2, 9});
  EXPECT_EQ(history_.cuts(), 2u);
  EXPECT_EQ(undo(), 2.5);
  EXPECT_EQ(now(), after_first);
  EXPECT_EQ(history_.cuts(), 1u);
  EXPECT_EQ(undo(), 0);
  EXPECT_EQ(now(), before_);
  EXPECT_EQ(history_.cuts(), 0u);
  EXPECT_EQ(undo(), 0);
}

TEST_F(CutHistoryTest, ACutWithoutAChangeIsNone) {
  history_.begin_cut(0);
  history_.begin_cut(0);
  mill({3, 4, 5});
  history_.begin_cut(1);
  history_.begin_cut(1);
  EXPECT_EQ(history_.cuts(), 1u);
  EXPECT_EQ(undo(), 0);
  EXPECT_EQ(now(), before_);
}

TEST_F(CutHistoryTest, ResetsPastEveryCut) {
  for (int n = 0; n < 5; ++n) {
    history_.begin_cut(n);
    mill({n, 4, 5});
  }
  undo();
  reset();
  EXPECT_EQ(now(), before_);
  EXPECT_EQ(history_.cuts(), 0u);
  EXPECT_FALSE(history_.is_touched());
}

TEST_F(CutHistoryTest, WhatBeginsBeforeACutIsDroppedIsAnotherCut) {
  mill({3, 4, 5});
  history_.begin_cut(2.5);
  mill({18, 2, 9});
  EXPECT_EQ(put(history_.state_before_last_cut()), 2.5);
  history_.begin_cut(4);
  EXPECT_EQ(history_.state_before_last_cut().removed_mm3, 2.5);
  history_.drop_last();
  EXPECT_EQ(history_.cuts(), 1u);
  mill({18, 2, 9});
  EXPECT_EQ(history_.cuts(), 2u);
  EXPECT_EQ(undo(), 2.5);
  EXPECT_EQ(undo(), 0);
  EXPECT_EQ(now(), before_);
}

TEST_F(CutHistoryTest, ForgetsTheOldestCutsBeyondItsMemory) {
  history_ = CutHistory(2 * sizeof(DensityBlock));
  for (int n = 0; n < 5; ++n) {
    history_.begin_cut(n);
    mill({n, 4, 5});
  }
  EXPECT_EQ(history_.cuts(), 2u);
  EXPECT_EQ(undo(), 4);
  EXPECT_EQ(undo(), 3);
  EXPECT_EQ(history_.cuts(), 0u);
  reset();
  EXPECT_EQ(now(), before_);
}

TEST_F(CutHistoryTest, NothingIsTouchedOnceTheOnlyCutIsTakenBack) {
  mill({3, 4, 5});
  EXPECT_TRUE(history_.is_touched());
  EXPECT_EQ(history_.cuts(), 1u);
  undo();
  EXPECT_FALSE(history_.is_touched());
  EXPECT_EQ(now(), before_);
}

// Inside bone of 1000: emptied to 300 and 0, cut in part to 400 and 700; and outside, which was not milled.
TEST_F(CutHistoryTest, WhatWasEmptiedStaysEmptyAtALowerIsovalueAndWhatWasCutInPartStaysAsItWas) {
  DensityGrid untouched = bone_.grid();
  const auto mill_to = [&](const VoxelIndex& voxel, float density) {
    while (bone_.grid()[voxel] > density) mill(voxel);
  };
  mill_to({3, 4, 2}, 300);
  history_.begin_cut(1);
  mill_to({3, 4, 3}, 0);
  mill_to({3, 4, 4}, 700);
  mill_to({3, 4, 5}, 400);
  DensityGrid milled = bone_.grid();
  EXPECT_TRUE(history_.lower_emptied_bricks(bone_.grid(), 300, 990, 300).empty());
  EXPECT_TRUE(history_.lower_emptied_bricks(bone_.grid(), 300, 350, 300).empty());
  std::vector<DensityBlock> differing = history_.lower_emptied_bricks(bone_.grid(), 300, 50, -30);
  ASSERT_EQ(differing.size(), 1u);
  EditableVolume(bone_).swap(differing.front());
  milled.set({3, 4, 2}, -30);
  EXPECT_EQ(now(), milled.densities());
  // The first cut's hole is still one when the second is taken back.
  undo();
  untouched.set({3, 4, 2}, -30);
  EXPECT_EQ(now(), untouched.densities());
  undo();
  EXPECT_EQ(now(), before_);
}

}  // namespace
}  // namespace osteomill
