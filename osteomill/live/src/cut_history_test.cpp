#include "cut_history.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/volume/editable_volume.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

// 20 voxels a side, so that the last bricks extend beyond the grid.
class CutHistoryTest : public ::testing::Test {
 protected:
  void mill(const VoxelIndex& voxel) {
    const VoxelIndex first{voxel.i / 8 * 8, voxel.j / 8 * 8, voxel.k / 8 * 8};
    const DensityBlock before(bone_.grid(), first);
    bone_.lower_density(voxel, bone_.grid()[voxel] - 100);
    history_.save(before);
  }
  double undo() {
    const double removed_mm3 = history_.state_before_last_cut().removed_mm3;
    history_.record_undo(put(history_.state_before_last_cut()), removed_mm3_);
    return removed_mm3_ = removed_mm3;
  }
  double redo() {
    const double removed_mm3 = history_.state_after_undone_cut().removed_mm3;
    history_.record_redo(put(history_.state_after_undone_cut()), removed_mm3_);
    return removed_mm3_ = removed_mm3;
  }
  void reset() {
    put(history_.state_before_all_cuts());
    history_.clear_history();
    removed_mm3_ = 0;
  }
  // Returns the bricks as they were before.
  std::vector<DensityBlock> put(const CutHistory::SavedState& state) {
    std::vector<DensityBlock> were;
    for (const auto& [place, brick] : state.bricks) were.push_back(brick);
    for (DensityBlock& brick : were) EditableVolume(bone_).swap(brick);
    return were;
  }
  const CopyOnWriteFloats& now() const { return bone_.grid().densities(); }

  Volume bone_ = testing_support::shape_volume(testing_support::centred_cube(20, 0.25),
                                               testing_support::plane(Vec3::Zero(), Vec3::UnitZ()));
  const CopyOnWriteFloats before_ = bone_.grid().densities();
  CutHistory history_{std::size_t{1} << 20};
  // Maintained by some tests only.
  double removed_mm3_ = 0;
};

TEST_F(CutHistoryTest, UndoesCutsOneByOne) {
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

TEST_F(CutHistoryTest, IgnoresCutsWithoutAChange) {
  history_.begin_cut(0);
  history_.begin_cut(0);
  mill({3, 4, 5});
  history_.begin_cut(1);
  history_.begin_cut(1);
  EXPECT_EQ(history_.cuts(), 1u);
  EXPECT_EQ(undo(), 0);
  EXPECT_EQ(now(), before_);
}

TEST_F(CutHistoryTest, ResetUndoesAllCuts) {
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

TEST_F(CutHistoryTest, CutBegunDuringAnUndoIsASeparateCut) {
  mill({3, 4, 5});
  history_.begin_cut(2.5);
  mill({18, 2, 9});
  EXPECT_EQ(history_.state_before_last_cut().removed_mm3, 2.5);
  const std::vector<DensityBlock> were = put(history_.state_before_last_cut());
  history_.begin_cut(4);
  EXPECT_EQ(history_.state_before_last_cut().removed_mm3, 2.5);
  history_.record_undo(were, 4);
  EXPECT_EQ(history_.cuts(), 1u);
  mill({18, 2, 9});
  EXPECT_EQ(history_.cuts(), 2u);
  EXPECT_EQ(undo(), 2.5);
  EXPECT_EQ(undo(), 0);
  EXPECT_EQ(now(), before_);
}

TEST_F(CutHistoryTest, DropsTheOldestCutsBeyondItsMemoryLimit) {
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

TEST_F(CutHistoryTest, IsUntouchedAfterUndoingTheOnlyCut) {
  mill({3, 4, 5});
  EXPECT_TRUE(history_.is_touched());
  EXPECT_EQ(history_.cuts(), 1u);
  undo();
  EXPECT_FALSE(history_.is_touched());
  EXPECT_EQ(now(), before_);
}

// Inside bone of density 1000: two voxels emptied to 300 and 0, two partially cut to 400 and 700; one
// outside, not milled.
TEST_F(CutHistoryTest, LowerIsovalueKeepsEmptiedVoxelsEmptyAndOthersUnchanged) {
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
  EXPECT_TRUE(history_.clear_emptied_voxels(bone_.grid(), 300, 990, 300).empty());
  EXPECT_TRUE(history_.clear_emptied_voxels(bone_.grid(), 300, 350, 300).empty());
  std::vector<DensityBlock> differing = history_.clear_emptied_voxels(bone_.grid(), 300, 50, -30);
  ASSERT_EQ(differing.size(), 1u);
  EditableVolume(bone_).swap(differing.front());
  milled.set({3, 4, 2}, -30);
  EXPECT_EQ(now(), milled.densities());
  // The hole of the first cut must remain after undoing the second.
  undo();
  untouched.set({3, 4, 2}, -30);
  EXPECT_EQ(now(), untouched.densities());
  undo();
  EXPECT_EQ(now(), before_);
}

// Compares with a plain list of whole copies of the bone.
TEST_F(CutHistoryTest, UndoAndRedoInAnyOrderMatchAListOfCopies) {
  std::mt19937 random(5);
  const auto any = [&](int count) { return std::uniform_int_distribution(0, count - 1)(random); };
  struct State {
    CopyOnWriteFloats densities;
    double removed_mm3;
  };
  std::vector<State> states{{now(), 0}};
  std::size_t at = 0;
  int undone = 0, redone = 0, over = 0;
  for (int n = 0; n < 2000; ++n) {
    const int what = any(20);
    if (what < 8) {
      if (at > 0) --at, ++undone;
      EXPECT_EQ(undo(), states[at].removed_mm3);
    } else if (what < 14) {
      if (at + 1 < states.size()) {
        ++at, ++redone;
        EXPECT_EQ(redo(), states[at].removed_mm3);
      }
    } else if (what == 14 && any(10) == 0) {
      reset();
      states.resize(1);
      at = 0;
    } else {
      over += at + 1 < states.size() ? 1 : 0;
      states.resize(at + 1);
      if (what == 19) {
        const DensityBlock before(bone_.grid(), {8 * any(3), 8 * any(3), 8 * any(3)});
        DensityBlock emptied = before;
        emptied.densities.fill(static_cast<float>(-n));
        EditableVolume(bone_).swap(emptied);
        history_.add_pieces({before}, removed_mm3_, {});
      } else {
        history_.begin_cut(removed_mm3_);
        for (int voxels = 1 + any(4); voxels > 0; --voxels) mill({any(20), any(20), any(20)});
        removed_mm3_ += 1 + n;
      }
      states.push_back({now(), removed_mm3_});
      ++at;
    }
    ASSERT_EQ(now(), states[at].densities) << n;
    ASSERT_EQ(history_.cuts(), at);
    ASSERT_EQ(history_.undone_cuts(), states.size() - 1 - at);
    ASSERT_EQ(history_.is_touched(), at > 0);
  }
  EXPECT_GT(undone, 400);
  EXPECT_GT(redone, 200);
  EXPECT_GT(over, 100);
}

TEST_F(CutHistoryTest, UndoneCutsUseCutMemoryAndAreDroppedByANewCut) {
  history_ = CutHistory(3 * sizeof(DensityBlock));
  for (int n = 0; n < 3; ++n) {
    history_.begin_cut(n);
    mill({n, 4, 5});
  }
  const CopyOnWriteFloats all = now();
  undo();
  undo();
  EXPECT_EQ(history_.undone_cuts(), 2u);
  history_.begin_cut(1);
  EXPECT_EQ(history_.undone_cuts(), 2u);
  redo();
  redo();
  EXPECT_EQ(now(), all);
  EXPECT_EQ(history_.cuts(), 3u);
  undo();
  undo();
  mill({9, 4, 5});
  EXPECT_EQ(history_.undone_cuts(), 0u);
  history_.begin_cut(2);
  mill({9, 4, 5});
  history_.begin_cut(3);
  mill({9, 4, 5});
  EXPECT_EQ(history_.cuts(), 3u);
}

// An undone cut holds emptied voxels, which a redo at a lower isovalue must not turn back into bone.
TEST_F(CutHistoryTest, RedoAtALowerIsovalueKeepsEmptiedVoxelsEmpty) {
  while (bone_.grid()[{3, 4, 3}] > 0) mill({3, 4, 3});
  DensityGrid milled = bone_.grid();
  undo();
  EXPECT_TRUE(history_.clear_emptied_voxels(bone_.grid(), 300, -50, -80).empty());
  redo();
  milled.set({3, 4, 3}, -80);
  EXPECT_EQ(now(), milled.densities());
}

TEST_F(CutHistoryTest, PieceDropsFollowUndoRedoAndReset) {
  const auto remove = [&](int n, double drop) {
    const DensityBlock before(bone_.grid(), {8 * n, 0, 0});
    bone_.lower_density({8 * n, 4, 5}, -1000);
    history_.add_pieces({before}, 0, {0, drop});
  };
  history_ = CutHistory(2 * sizeof(DensityBlock));
  remove(0, 1);
  mill({3, 4, 5});
  EXPECT_EQ(history_.piece_drops(), (std::vector<double>{0, 1}));
  undo();
  remove(1, 2);
  EXPECT_EQ(history_.piece_drops(), (std::vector<double>{0, 3}));
  undo();
  EXPECT_EQ(history_.piece_drops(), (std::vector<double>{0, 1}));
  redo();
  EXPECT_EQ(history_.piece_drops(), (std::vector<double>{0, 3}));
  // The first removal can no longer be undone but still counts.
  remove(2, 4);
  EXPECT_EQ(history_.cuts(), 2u);
  EXPECT_EQ(history_.piece_drops(), (std::vector<double>{0, 7}));
  reset();
  EXPECT_TRUE(history_.piece_drops().empty());
  EXPECT_EQ(now(), before_);
}

}  // namespace
}  // namespace osteomill
