#include "osteomill/live/live_milling.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/recorded_bone.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/session/milling_entry.h"
#include "osteomill/session/virtual_hand.h"
#include "osteomill/visual/surface_mesh.h"
#include "osteomill/volume/bone_pieces.h"

#include "tests/no_more_threads.h"
#include "tests/shapes.h"
#include "tests/support/mesh_checks.h"
#include "tests/support/recording_samples.h"
#include "tests/wait.h"

namespace osteomill {
namespace {

using namespace std::chrono_literals;
using testing_support::becomes_true_in_time;
using testing_support::mesh_of;
using testing_support::mesh_surface;

constexpr double kIsovalue = 500;

std::shared_ptr<Volume> ball_of_bone() {
  auto bone = std::make_shared<Volume>(testing_support::shape_volume(
      testing_support::centred_cube(51, 0.25), testing_support::ball(Vec3::Zero(), 5.0)));
  // Labels the left and the right half.
  std::vector<LabelMap::LabelIndex> places;
  for (std::size_t n = 0; n < bone->geometry().voxel_count(); ++n) places.push_back(n % 51 < 25 ? 1 : 2);
  const GridGeometry& grid = bone->geometry();
  bone->set_labels(
      std::make_shared<const LabelMap>(std::vector<Label>{{1, "left"}, {2, "right"}}, grid, grid, places));
  return bone;
}

// A hand that presses the burr into the top of a ball of bone.
class LiveMillingTest : public ::testing::Test {
 protected:
  LiveMillingTest() : LiveMillingTest(ball_of_bone()) {}
  explicit LiveMillingTest(std::shared_ptr<Volume> scan) : bone_(std::move(scan)) {
    milling_.start();
    hand_.pull_to(pose_above(entry_, setup_.tool, -1.0));
  }

  // Mills until `more_mm3` more is removed.
  void mill(double more_mm3) {
    const double before_mm3 = milling_.state().record.removed_mm3;
    milling_.set_spindle(true);
    for (int n = 0; n < 12000 && milling_.state().record.removed_mm3 < before_mm3 + more_mm3; ++n) {
      milling_.update();
      std::this_thread::sleep_for(5ms);
    }
    milling_.set_spindle(false);
    EXPECT_GE(milling_.state().record.removed_mm3, before_mm3 + more_mm3);
  }

  // A restarted session renders no force until the tool is out of bone.
  void start_again() {
    const Pose X_W_out = pose_above(entry_, setup_.tool, 2.0);
    milling_.start();
    hand_.pull_to(X_W_out);
    EXPECT_TRUE(becomes_true_in_time([&] {
      const TickRecord& record = milling_.state().record;
      return is_zero(record.wrench) && (record.X_WD.position_mm - X_W_out.position_mm).norm() < 0.5;
    }));
    hand_.pull_to(pose_above(entry_, setup_.tool, -1.0));
  }

  // Returns when the follower has received all milling, however far behind it was: every preparation waits
  // for that.
  void settle() {
    EXPECT_TRUE(milling_.change(milling_.setup()));
    milling_.finish_preparing();
  }

  CopyOnWriteFloats bone() {
    settle();
    CopyOnWriteFloats densities;
    milling_.follower().read([&](const Volume& bone) { densities = bone.grid().densities(); });
    return densities;
  }

  // Returns whether the surface taken brick by brick converges to that of the bone.
  bool surface_is_the_bones() {
    for (int n = 0; n < 200; ++n) {
      for (const auto& [number, brick] : milling_.take_changed_bricks()) surface_[number] = mesh_of(brick);
      bool same = false;
      milling_.follower().read(
          [&](const Volume& bone) { same = surface_ == mesh_surface(DensityView(bone)).bricks; });
      if (same) return true;
      std::this_thread::sleep_for(20ms);
    }
    return false;
  }

  std::shared_ptr<Volume> bone_;
  MillingSetup setup_;
  MillingEntry entry_ = place_entry(*bone_, setup_.tool);
  VirtualHand hand_{{}, pointing_hand(), pose_above(entry_, setup_.tool, 0.2)};
  LiveMilling milling_{bone_, setup_, hand_};
  const CopyOnWriteFloats untouched_ = ball_of_bone()->grid().densities();
  std::vector<BrickMesh> surface_ = std::vector<BrickMesh>(milling_.follower().layout().count());
};

// Catching up hands changes over while no ticks run; a start at that moment must not lead to two threads
// doing so.
TEST_F(LiveMillingTest, SurfaceMatchesBoneAfterRestartsDuringUndo) {
  mill(0.3);
  for (int n = 0; n < 5; ++n) {
    milling_.stop();
    EXPECT_TRUE(milling_.undo());
    start_again();
    milling_.finish_preparing();
    mill(0.02);
  }
  EXPECT_TRUE(surface_is_the_bones());
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(LiveMillingTest, UndoThrowsAndKeepsTheCutWhenNoThreadCanStart) {
  mill(0.3);
  {
    const testing_support::NoMoreThreads none;
    EXPECT_THROW((void)milling_.undo(), std::system_error);
  }
  EXPECT_FALSE(milling_.is_preparing());
  EXPECT_EQ(milling_.follower().cuts(), 1u);
  mill(0.1);
}
#endif

TEST_F(LiveMillingTest, UndoesTheLastCutMillsOnAndResetsToTheScan) {
  mill(0.3);
  const CopyOnWriteFloats after_first = bone();
  const double removed_mm3 = milling_.state().record.removed_mm3;
  mill(0.3);
  EXPECT_EQ(milling_.follower().cuts(), 2u);
  EXPECT_NE(bone(), after_first);
  EXPECT_TRUE(milling_.undo());
  milling_.finish_preparing();
  EXPECT_EQ(bone(), after_first);
  EXPECT_EQ(milling_.state().record.removed_mm3, removed_mm3);
  const std::vector<double> of_label_mm3 = milling_.removed_by_label();
  ASSERT_EQ(of_label_mm3.size(), 3u);
  EXPECT_NEAR(of_label_mm3[1] + of_label_mm3[2], removed_mm3, 1e-6);
  EXPECT_GT(of_label_mm3[1], 0.2 * removed_mm3);
  EXPECT_GT(of_label_mm3[2], 0.2 * removed_mm3);
  EXPECT_EQ(milling_.follower().cuts(), 1u);
  EXPECT_TRUE(surface_is_the_bones());
  mill(0.3);
  EXPECT_EQ(milling_.follower().cuts(), 2u);
  EXPECT_TRUE(surface_is_the_bones());
  EXPECT_TRUE(milling_.reset());
  milling_.finish_preparing();
  EXPECT_EQ(bone(), untouched_);
  EXPECT_EQ(milling_.state().record.removed_mm3, 0);
  EXPECT_EQ(milling_.removed_by_label(), (std::vector<double>{0, 0, 0}));
  EXPECT_FALSE(milling_.follower().is_touched());
  EXPECT_TRUE(surface_is_the_bones());
}

// The follower shows the bone that the haptic thread mills, also after several exchanges of the two.
TEST_F(LiveMillingTest, FollowerShowsTheBoneFeltAfterRepeatedUndos) {
  for (int n = 0; n < 3; ++n) {
    mill(0.2);
    EXPECT_TRUE(milling_.undo());
    milling_.finish_preparing();
    mill(0.2);
  }
  settle();
  const std::uint64_t version = milling_.follower().version();
  hand_.pull_to(pose_above(entry_, setup_.tool, -4.0));
  for (int n = 0; n < 400 && milling_.state().record.wrench.force_N.norm() < 1.0; ++n) {
    std::this_thread::sleep_for(5ms);
  }
  // The burr rests on the remaining bone: its lowest point is on the surface of the copy.
  const Pose X_WT = milling_.state().record.X_WT;
  const Vec3 lowest_W = X_WT.position_mm + setup_.tool.burr_radius_mm * entry_.direction_W;
  milling_.follower().read([&](const Volume& bone) {
    const GridGeometry& geometry = bone.geometry();
    const auto density_at = [&](const Vec3& point_W) {
      const Vec3 voxel = geometry.voxel_from_world(point_W);
      return bone.grid()[{static_cast<int>(std::lround(voxel.x())), static_cast<int>(std::lround(voxel.y())),
                          static_cast<int>(std::lround(voxel.z()))}];
    };
    EXPECT_GT(density_at(lowest_W + 0.5 * entry_.direction_W), kIsovalue);
    EXPECT_LT(density_at(X_WT.position_mm), kIsovalue);
  });
  EXPECT_EQ(milling_.follower().version(), version);
}

TEST_F(LiveMillingTest, ChangesAlgorithmAndToolWithoutChangingTheBone) {
  mill(0.2);
  const double removed_mm3 = milling_.state().record.removed_mm3;
  const CopyOnWriteFloats milled = bone();
  MillingSetup other = setup_;
  other.algorithm = algorithm_named("surface-points");
  other.tool.burr_radius_mm = 1.2;
  EXPECT_TRUE(milling_.change(other));
  EXPECT_TRUE(milling_.is_preparing());
  EXPECT_FALSE(milling_.undo());  // refused during a preparation
  milling_.finish_preparing();
  EXPECT_FALSE(milling_.is_preparing());
  EXPECT_EQ(milling_.setup().algorithm.id, "surface-points");
  EXPECT_EQ(bone(), milled);
  EXPECT_EQ(milling_.state().record.removed_mm3, removed_mm3);
  mill(0.2);
  EXPECT_TRUE(milling_.is_running());
}

TEST_F(LiveMillingTest, KeepsSetupAndBoneWhenPreparationFails) {
  mill(0.2);
  const CopyOnWriteFloats milled = bone();
  MillingSetup wrong = setup_;
  wrong.tool.burr_radius_mm = -1;
  EXPECT_TRUE(milling_.change(wrong));
  EXPECT_THROW(milling_.finish_preparing(), std::invalid_argument);
  EXPECT_EQ(milling_.setup().tool.burr_radius_mm, setup_.tool.burr_radius_mm);
  EXPECT_TRUE(milling_.change_isovalue(std::numeric_limits<double>::quiet_NaN()));
  EXPECT_THROW(milling_.finish_preparing(), std::invalid_argument);
  EXPECT_EQ(milling_.isovalue(), kIsovalue);
  EXPECT_EQ(bone(), milled);
  mill(0.1);
}

// Mills a hole with partially cut sides and changes the isovalue up and back over the bone's whole range.
TEST_F(LiveMillingTest, KeepsMilledBoneBitIdenticalAcrossIsovalueChanges) {
  mill(0.3);
  const CopyOnWriteFloats milled = bone();
  for (const double isovalue : {990.0, 300.0, kIsovalue}) {
    EXPECT_TRUE(milling_.change_isovalue(isovalue));
    milling_.finish_preparing();
    EXPECT_EQ(milling_.isovalue(), isovalue);
    EXPECT_EQ(bone(), milled);
    EXPECT_TRUE(surface_is_the_bones());
  }
  EXPECT_TRUE(milling_.change_isovalue(300));
  milling_.finish_preparing();
  EXPECT_TRUE(milling_.undo());
  milling_.finish_preparing();
  EXPECT_EQ(bone(), untouched_);
  EXPECT_FALSE(milling_.follower().is_touched());
  milling_.follower().read([](const Volume& bone) { EXPECT_EQ(bone.isovalue(), 300); });
  EXPECT_TRUE(surface_is_the_bones());
}

// A session with the ball of bone and a smaller ball beside it.
class LiveMillingOfTwoPiecesTest : public LiveMillingTest {
 protected:
  static constexpr VoxelIndex kInSmall{47, 47, 47};
  static std::shared_ptr<Volume> two_balls() {
    const auto ball = ball_of_bone();
    DensityGrid grid = ball->grid();
    for_each({{45, 45, 45}, {49, 49, 49}}, [&](const VoxelIndex& v) { grid.set(v, 900); });
    auto bone = std::make_shared<Volume>(std::move(grid), kIsovalue);
    bone->set_labels(ball->labels());
    return bone;
  }
  LiveMillingOfTwoPiecesTest() : LiveMillingTest(two_balls()) {}

  void finish(bool begun) {
    EXPECT_TRUE(begun);
    milling_.finish_preparing();
  }
  bool has_small() {
    bool is_bone = false;
    milling_.follower().read([&](const Volume& now) { is_bone = now.is_bone(kInSmall); });
    return is_bone;
  }
};

TEST_F(LiveMillingOfTwoPiecesTest, RemovesPiecesAsUndoableCutsNotCountedAsMilled) {
  mill(0.2);
  const CopyOnWriteFloats milled = bone();
  const double removed_mm3 = milling_.state().record.removed_mm3;
  const std::vector<double> of_label_mm3 = milling_.removed_by_label();
  EXPECT_TRUE(has_small());
  finish(milling_.remove_pieces({PieceRemoval::Which::chosen, kInSmall}));
  EXPECT_FALSE(has_small());
  const CopyOnWriteFloats without = bone();
  EXPECT_EQ(milling_.follower().cuts(), 2u);
  EXPECT_EQ(milling_.state().record.removed_mm3, removed_mm3);
  for (std::size_t label = 0; label < 3; ++label)
    EXPECT_NEAR(milling_.removed_by_label()[label], of_label_mm3[label], 1e-9);
  EXPECT_TRUE(surface_is_the_bones());
  // The haptic thread mills the bone without the piece; that is a cut of its own.
  mill(0.2);
  EXPECT_FALSE(has_small());
  EXPECT_EQ(milling_.follower().cuts(), 3u);
  const CopyOnWriteFloats milled_on = bone();
  const double removed_then_mm3 = milling_.state().record.removed_mm3;
  finish(milling_.undo());
  EXPECT_EQ(bone(), without);
  finish(milling_.undo());
  EXPECT_EQ(bone(), milled);
  EXPECT_EQ(milling_.follower().undone_cuts(), 2u);
  finish(milling_.redo());
  EXPECT_EQ(bone(), without);
  EXPECT_EQ(milling_.state().record.removed_mm3, removed_mm3);
  finish(milling_.redo());
  EXPECT_EQ(bone(), milled_on);
  EXPECT_EQ(milling_.state().record.removed_mm3, removed_then_mm3);
  EXPECT_TRUE(surface_is_the_bones());
  const std::vector<double> now_mm3 = milling_.removed_by_label();
  EXPECT_NEAR(now_mm3[1] + now_mm3[2], removed_then_mm3, 1e-6);
  finish(milling_.reset());
  EXPECT_TRUE(has_small());
  EXPECT_EQ(milling_.follower().undone_cuts(), 0u);
  EXPECT_TRUE(surface_is_the_bones());
}

TEST_F(LiveMillingOfTwoPiecesTest, RedoAfterANewCutChangesNothing) {
  mill(0.1);
  finish(milling_.undo());
  mill(0.1);
  const CopyOnWriteFloats milled = bone();
  const double removed_mm3 = milling_.state().record.removed_mm3;
  ASSERT_GT(removed_mm3, 0);
  ASSERT_EQ(milling_.follower().undone_cuts(), 0u);
  finish(milling_.redo());
  EXPECT_EQ(bone(), milled);
  EXPECT_EQ(milling_.state().record.removed_mm3, removed_mm3);
  EXPECT_EQ(milling_.follower().cuts(), 1u);
  finish(milling_.undo());
  EXPECT_NE(bone(), milled);
}

TEST_F(LiveMillingOfTwoPiecesTest, InvalidOrEmptyPieceRemovalKeepsTheBone) {
  const CopyOnWriteFloats before = bone();
  EXPECT_TRUE(milling_.remove_pieces({PieceRemoval::Which::chosen, {0, 0, 0}}));
  EXPECT_THROW(milling_.finish_preparing(), std::invalid_argument);
  // No piece is that small.
  finish(milling_.remove_pieces({PieceRemoval::Which::smaller, {}, 0.1}));
  EXPECT_EQ(bone(), before);
  EXPECT_EQ(milling_.follower().cuts(), 0u);
  EXPECT_FALSE(milling_.follower().is_touched());
  mill(0.1);
}

// Pieces removed, restored and removed again in a recording, with cuts between, replay to the bit.
TEST_F(LiveMillingOfTwoPiecesTest, ReplaysPieceRemovalsFromARecordingBitIdentically) {
  const testing_support::TestFolder folder;
  mill(0.1);
  milling_.start_recording(folder / "a.h5", milling_.describe("balls", ""));
  mill(0.1);
  finish(milling_.remove_pieces({PieceRemoval::Which::all_but_chosen, {25, 25, 20}}));
  EXPECT_FALSE(has_small());
  mill(0.1);
  finish(milling_.undo());
  finish(milling_.undo());
  mill(0.05);
  finish(milling_.undo());
  finish(milling_.remove_pieces({PieceRemoval::Which::smaller, {}, 100}));
  mill(0.1);
  finish(milling_.undo());
  finish(milling_.redo());
  mill(0.05);
  const CopyOnWriteFloats at_end = bone();
  const std::vector<double> of_label_mm3 = milling_.removed_by_label();
  milling_.stop();
  milling_.stop_recording();
  const Recording recording = read_recording(folder / "a.h5");
  EXPECT_GE(recording.sessions.size(), 8u);
  const auto scan = two_balls();
  const Verification verified = verify_recording(*scan, recording);
  EXPECT_FALSE(verified.difference) << verified.difference->sentence();
  EXPECT_EQ(verified.ticks, recording.records.size());
  EXPECT_GT(verified.compared_bones, 5u);
  Volume milled = *scan;
  repeat_milling(milled, recording);
  EXPECT_EQ(milled.grid().densities(), at_end);
  // Playing forwards and back gives the bone of every session.
  RecordedBone played(*scan, recording);
  EXPECT_EQ(played.bone().grid().densities(), at_end);
  played.go_to(1);
  EXPECT_TRUE(played.bone().is_bone(kInSmall));
  played.go_to(recording.records.size());
  EXPECT_EQ(played.bone().grid().densities(), at_end);

  // Continues from the recording's end, and from the state that a window stores for its next start.
  const double end_s = recording.records.back().time_s;
  VirtualHand hand({}, pointing_hand(), pose_above(entry_, setup_.tool, 0.2));
  LiveMilling branch(prepare_milling(two_balls(), resume_recording(*scan, recording, end_s), {}), hand);
  const SessionStart before{.run = milling_.describe("balls", ""),
                            .removed_mm3 = recording.records.back().removed_mm3,
                            .bricks = milling_.follower().touched_bricks(),
                            .piece_drops = milling_.follower().piece_drops()};
  LiveMilling again(prepare_milling(two_balls(), setup_, before), hand);
  for (LiveMilling* next : {&branch, &again}) {
    next->follower().read([&](const Volume& now) { EXPECT_EQ(now.grid().densities(), at_end); });
    for (std::size_t label = 0; label < 3; ++label)
      EXPECT_NEAR(next->removed_by_label()[label], of_label_mm3[label], 1e-9);
    EXPECT_TRUE(next->undo());
    next->finish_preparing();
    next->follower().read([&](const Volume& now) { EXPECT_TRUE(now.is_bone(kInSmall)); });
    EXPECT_EQ(next->removed_by_label(), (std::vector<double>{0, 0, 0}));
  }
}

// Bone milled in a closed window continues in another.
TEST_F(LiveMillingTest, RestoresMilledBoneInANewSessionAndCanUndoIt) {
  mill(0.3);
  const double removed_mm3 = milling_.state().record.removed_mm3;
  const CopyOnWriteFloats milled = bone();
  milling_.stop();

  VirtualHand hand({}, pointing_hand(), pose_above(entry_, setup_.tool, 0.2));
  const SessionStart before{.run = milling_.describe("ball", ""),
                            .removed_mm3 = removed_mm3,
                            .bricks = milling_.follower().touched_bricks()};
  const auto another = ball_of_bone();
  another->lower_density({25, 25, 25}, 1);
  EXPECT_THROW(prepare_milling(another, setup_, before), InputError);
  LiveMilling again(prepare_milling(ball_of_bone(), setup_, before), hand);
  const auto bone_again = [&] {
    CopyOnWriteFloats densities;
    again.follower().read([&](const Volume& bone) { densities = bone.grid().densities(); });
    return densities;
  };
  EXPECT_EQ(bone_again(), milled);
  EXPECT_TRUE(again.follower().is_touched());
  again.start();
  for (int n = 0; n < 2000 && again.timing().ticks == 0; ++n) std::this_thread::sleep_for(5ms);
  EXPECT_EQ(again.state().record.removed_mm3, removed_mm3);
  EXPECT_EQ(again.follower().cuts(), 1u);
  EXPECT_TRUE(again.undo());
  again.finish_preparing();
  EXPECT_EQ(bone_again(), untouched_);
}

// Another hand continues while the burr presses on bone, and feels nothing until it has moved off the bone.
TEST_F(LiveMillingTest, ResumesFromARecordedTickWithoutAForceStep) {
  const testing_support::TestFolder folder;
  milling_.start_recording(folder / "a.h5", milling_.describe("ball", ""));
  mill(0.3);
  hand_.pull_to(pose_above(entry_, setup_.tool, -3.0));
  EXPECT_TRUE(becomes_true_in_time([&] { return milling_.state().record.wrench.force_N.norm() > 0.5; }));
  milling_.stop();
  milling_.stop_recording();
  const Recording recording = read_recording(folder / "a.h5");
  const auto pressing = std::ranges::max_element(
      recording.records, {}, [](const TickRecord& record) { return record.wrench.force_N.norm(); });
  ASSERT_GT(pressing->wrench.force_N.norm(), 0.5);
  ASSERT_GT(pressing->removed_mm3, 0);
  const ResumedRecording resumed = resume_recording(*ball_of_bone(), recording, pressing->time_s);
  VirtualHand hand({}, pointing_hand(), pose_above(entry_, setup_.tool, 20));
  LiveMilling again(prepare_milling(ball_of_bone(), resumed, {}), hand);
  EXPECT_EQ(again.setup().tool, setup_.tool);
  again.start_recording(folder / "b.h5", again.describe("ball", ""));
  again.start();
  EXPECT_TRUE(becomes_true_in_time([&] { return again.timing().ticks > 400; }));
  again.stop();
  again.stop_recording();
  const Recording branch = read_recording(folder / "b.h5");
  const TickRecord& first = branch.records.front();
  EXPECT_EQ(first.time_s, pressing->time_s + pressing->dt_s);
  // The pose is rounded by an encoder, and the tool is moved out of the bone.
  EXPECT_LT((first.X_WT.position_mm - pressing->X_WT.position_mm).norm(), 0.05);
  EXPECT_LT((first.X_WD.position_mm - pressing->X_WT.position_mm).norm(), 0.01);
  EXPECT_FALSE(first.driven);
  EXPECT_TRUE(first.placed);
  EXPECT_TRUE(is_zero(first.wrench));
  EXPECT_EQ(branch.records.back().removed_mm3, pressing->removed_mm3) << "no one switched the spindle on";
  for (std::size_t n = 1; n < branch.records.size(); ++n) {
    const Vec3 step_N = branch.records[n].wrench.force_N - branch.records[n - 1].wrench.force_N;
    ASSERT_LE(step_N.norm(), 1e-3 * kHandWrenchRates.force_N_s + 1e-9) << "at tick " << n;
  }
  // The branch can be replayed and measured by itself.
  const Verification verified = verify_recording(*ball_of_bone(), branch);
  EXPECT_FALSE(verified.difference) << verified.difference->sentence();
  Volume milled = *ball_of_bone();
  repeat_milling(milled, branch);
  EXPECT_EQ(milled.change_hash(), resumed.session->volume().change_hash());
  EXPECT_EQ(again.follower().cuts(), 1u);
  EXPECT_TRUE(again.undo());
  again.finish_preparing();
  again.follower().read([&](const Volume& bone) { EXPECT_EQ(bone.grid().densities(), untouched_); });
}

// Pressed into the bone, deep in it, and far away: every algorithm releases the force without a step and
// renders none at the tool's new pose.
TEST_F(LiveMillingTest, PlacesTheToolWithoutAForceStep) {
  const Pose X_W_free = pose_above(entry_, setup_.tool, 5.0);
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    setup_.algorithm = algorithm;
    EXPECT_TRUE(milling_.change(setup_));
    milling_.finish_preparing();
    for (const double above_mm : {-1.0, -4.0, 500.0}) {
      hand_.pull_to(pose_above(entry_, setup_.tool, above_mm));
      std::this_thread::sleep_for(300ms);
      // On a busy machine a tick may be so late that zero is sent at the maximum rate for a hand.
      double allowed_step_N = 0.4;
      const auto allow_for_late = [&](const TickRecord& record) {
        if (record.fault == WrenchFault::tick_late) allowed_step_N = 1e-3 * kHandWrenchRates.force_N_s + 1e-9;
      };
      while (const auto record = milling_.next_record()) allow_for_late(*record);
      // Switched on earlier, the burr could mill until `place` is called.
      milling_.place(X_W_free);
      milling_.set_spindle(true);
      ASSERT_TRUE(becomes_true_in_time([&] { return !milling_.is_placing(); })) << "the tool was not placed";
      milling_.set_spindle(false);
      EXPECT_LT((milling_.state().record.X_WD.position_mm - X_W_free.position_mm).norm(), 0.1);
      std::this_thread::sleep_for(20ms);
      double force_N = -1;
      double max_step_N = 0;
      double removed_mm3 = -1;
      while (const auto record = milling_.next_record()) {
        const double now_N = record->wrench.force_N.norm();
        allow_for_late(*record);
        if (force_N >= 0) max_step_N = std::max(max_step_N, std::abs(now_N - force_N));
        force_N = now_N;
        if (removed_mm3 < 0) removed_mm3 = record->removed_mm3;
        EXPECT_LE(record->removed_mm3, removed_mm3 + 1e-3);
      }
      EXPECT_EQ(force_N, 0) << algorithm.id.name << " from " << above_mm;
      EXPECT_LT(max_step_N, allowed_step_N) << algorithm.id.name << " from " << above_mm;
      EXPECT_LT((milling_.state().record.X_WT.position_mm - X_W_free.position_mm).norm(), 0.1);
    }
  }
}

// Starts in the middle of milling and continues across another algorithm, an undone cut, a pause, another
// pose, another isovalue and a reset; replays to the bit from the scan.
TEST_F(LiveMillingTest, RecordingContinuesAcrossChangesUndoPauseAndReset) {
  const testing_support::TestFolder folder;
  const auto path = folder / "live.h5";
  mill(0.1);
  unsigned char pictures = 0;
  milling_.start_recording(path, milling_.describe("ball", ""),
                           [&](std::string_view) { return std::vector<unsigned char>{++pictures}; });
  milling_.finish_preparing();
  mill(0.1);
  setup_.algorithm = algorithm_named("surface-points");
  setup_.vibration.on = setup_.cutting_reaction = true;
  setup_.guard.passivity_controller = true;
  setup_.guard.limits.force_N = 2;
  EXPECT_TRUE(milling_.change(setup_));
  milling_.finish_preparing();
  mill(0.1);
  EXPECT_TRUE(milling_.undo());
  milling_.finish_preparing();
  milling_.set_paused(true);
  std::this_thread::sleep_for(20ms);
  milling_.set_paused(false);
  milling_.place(pose_above(entry_, setup_.tool, 5.0));
  ASSERT_TRUE(becomes_true_in_time([&] { return !milling_.is_placing(); })) << "the tool was not placed";
  EXPECT_TRUE(milling_.change_isovalue(300));
  milling_.finish_preparing();
  hand_.pull_to(pose_above(entry_, setup_.tool, -1.0));
  mill(0.1);
  EXPECT_TRUE(milling_.reset());
  milling_.finish_preparing();
  mill(0.1);
  ASSERT_TRUE(milling_.is_recording());
  EXPECT_FALSE(milling_.has_recording_failed());
  EXPECT_EQ(milling_.stop_recording(), path);

  const Recording recording = read_recording(path);
  ASSERT_EQ(recording.pictures.size(), 3u);
  EXPECT_EQ(recording.pictures[0].name, kPictureAfter);
  EXPECT_EQ(recording.pictures[0].png, std::vector<unsigned char>{2});
  EXPECT_EQ(recording.pictures[1].name, kPictureAlong);
  EXPECT_EQ(recording.pictures[1].png, std::vector<unsigned char>{3});
  EXPECT_EQ(recording.pictures[2].png, std::vector<unsigned char>{1});
  ASSERT_EQ(recording.sessions.size(), 5u);
  EXPECT_FALSE(recording.sessions[0].start.bricks.empty()) << "of what was milled before";
  EXPECT_TRUE(recording.sessions[4].start.bricks.empty()) << "as scanned";
  EXPECT_EQ(recording.sessions[1].start.run.algorithm, "surface-points");
  EXPECT_EQ(recording.sessions[3].start.run.isovalue, 300);
  const Volume scan = *ball_of_bone();
  const Verification verified = verify_recording(scan, recording);
  EXPECT_FALSE(verified.difference) << verified.difference->record << ": " << verified.difference->what;
  EXPECT_EQ(verified.ticks, recording.records.size());
  Volume milled = scan;
  repeat_milling(milled, recording);
  EXPECT_EQ(milled.grid().densities(), bone());
}

TEST_F(LiveMillingTest, RecordsTheNewAlgorithmWhenStartedDuringItsPreparation) {
  const testing_support::TestFolder folder;
  setup_.algorithm = algorithm_named("surface-points");
  EXPECT_TRUE(milling_.change(setup_));
  milling_.start_recording(folder / "live.h5", milling_.describe("ball", ""));
  milling_.finish_preparing();
  mill(0.1);
  milling_.stop_recording();
  const Recording recording = read_recording(folder / "live.h5");
  EXPECT_EQ(recording.description.algorithm, "surface-points");
  EXPECT_FALSE(verify_recording(*ball_of_bone(), recording).difference);
}

TEST_F(LiveMillingTest, LeavesNoRecordingWhenItsSessionCannotBePrepared) {
  const testing_support::TestFolder folder;
  bool fails = false;
  setup_.algorithm.make = [&fails, make = setup_.algorithm.make](std::span<const double> values) {
    if (fails) throw std::invalid_argument("no more of it");
    return make(values);
  };
  EXPECT_TRUE(milling_.change(setup_));
  milling_.finish_preparing();
  fails = true;
  milling_.start_recording(folder / "live.h5", milling_.describe("ball", ""));
  EXPECT_THROW(milling_.finish_preparing(), std::invalid_argument);
  EXPECT_FALSE(milling_.is_recording());
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  fails = false;
  mill(0.1);
}

TEST_F(LiveMillingTest, RecordingBeforeTheFirstTickNeedsNoPreparation) {
  const testing_support::TestFolder folder;
  VirtualHand hand({}, pointing_hand(), pose_above(entry_, setup_.tool, 0.2));
  LiveMilling milling(ball_of_bone(), setup_, hand);
  milling.start_recording(folder / "live.h5", milling.describe("ball", ""));
  EXPECT_FALSE(milling.is_preparing());
  milling.start();
  for (int n = 0; n < 2000 && milling.timing().ticks < 50; ++n) std::this_thread::sleep_for(5ms);
  milling.stop();
  milling.stop_recording();
  const Recording recording = read_recording(folder / "live.h5");
  EXPECT_GT(recording.records.size(), 10u);
  EXPECT_FALSE(verify_recording(*ball_of_bone(), recording).difference);
}

TEST_F(LiveMillingTest, UndoesWhileStoppedAndMillsAfterRestart) {
  mill(0.2);
  milling_.stop();
  EXPECT_TRUE(milling_.undo());
  milling_.finish_preparing();
  EXPECT_EQ(bone(), untouched_);
  start_again();
  mill(0.1);
}

}  // namespace
}  // namespace osteomill
