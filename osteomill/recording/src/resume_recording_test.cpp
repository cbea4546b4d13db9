#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recorded_bone.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/editable_volume.h"

#include "tests/shapes.h"
#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

using testing_support::TestFolder;

Volume fresh_ball() {
  return testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                       testing_support::ball(Vec3::Zero(), 5));
}

struct Stretch {
  const char* algorithm;
  double burr_radius_mm;
  // Index of the session to whose initial bone this one resets; -1 for none.
  int back_to = -1;
};

SessionSettings settings_of(const Stretch& stretch) {
  SessionSettings session;
  MillingSetup& setup = session.setup;
  setup.algorithm = algorithm_named(stretch.algorithm);
  setup.tool.burr_radius_mm = stretch.burr_radius_mm;
  setup.law = CuttingLaw::chips;
  setup.handpiece = Handpiece::surgical;
  setup.cutting_reaction = setup.drag = true;
  setup.vibration.on = true;
  session.densities = {0, 1000};
  return session;
}

// Simulated hand that presses, slides and rests, with ticks of two lengths.
TickRecord tick(MillingSession& session, int n) {
  PosedDevice device;
  Pose pose;
  pose.position_mm = {1.5 * std::sin(0.002 * n), std::sin(0.0013 * n), 6.6 - 1.2 * std::sin(0.007 * n)};
  pose.orientation = quaternion_from_rotation_vector({0.2 * std::sin(0.003 * n), 0.1, 0});
  device.put(pose, n % 50 < 40 ? 1 : 0.5, n % 700 != 350);
  if (n % 900 == 450) session.fade_out();
  if (n % 900 == 600) session.place();
  return session.tick(device, {.time_s = 1e-3 * n,
                               .dt_s = n % 7 == 0 ? 1.2e-3 : 1e-3,
                               .spindle_on = n % 500 < 450,
                               .paused = n % 1000 > 970});
}

// Recording of several sessions with undo, reset, and changes of algorithm and burr.
class ResumeRecordingTest : public ::testing::Test {
 protected:
  void record(const std::vector<Stretch>& stretches, int ticks_each) {
    std::vector<Volume> bones;
    std::vector<double> removed_mm3;
    std::unique_ptr<MillingSession> session;
    std::optional<Recorder> recorder;
    for (std::size_t number = 0; number < stretches.size(); ++number) {
      const Stretch& stretch = stretches[number];
      const SessionSettings settings = settings_of(stretch);
      const auto back = static_cast<std::size_t>(stretch.back_to);
      bones.push_back(stretch.back_to >= 0 ? bones[back] : session ? session->volume() : scan_);
      removed_mm3.push_back(stretch.back_to >= 0 ? removed_mm3[back] : session ? session->removed_mm3() : 0);
      const RunDescription run = describe_run(scan_, {"ball", fingerprint_of(scan_.grid())}, settings, 0);
      SessionHandover before;
      if (session) before = session->handover();
      session = std::make_unique<MillingSession>(std::make_shared<Volume>(bones.back()), settings.densities,
                                                 settings.setup);
      session->count_removed_from(removed_mm3.back());
      session->resume_from(before);
      if (!recorder) recorder.emplace(folder_ / "a.h5", run, Recorder::FirstSession::begins_when_announced);
      recorder->begin_session(static_cast<std::uint32_t>(number),
                              {.run = run,
                               .handover = before,
                               .removed_mm3 = removed_mm3.back(),
                               .bricks = differing_blocks(bones.back().grid(), scan_.grid())});
      for (int n = 0; n < ticks_each; ++n) {
        TickRecord record = tick(*session, static_cast<int>(ticks_.size()));
        record.session = static_cast<std::uint32_t>(number);
        recorder->push_waiting(record);
        ticks_.push_back(record);
      }
    }
    recorder->close();
    recording_ = read_recording(folder_ / "a.h5");
    ASSERT_GT(std::ranges::max(ticks_, {}, &TickRecord::removed_mm3).removed_mm3, 0.1);
  }

  TestFolder folder_;
  Volume scan_ = fresh_ball();
  Recording recording_;
  // Ticks as run, each with the bone's hash after it.
  std::vector<TickRecord> ticks_;
};

std::string refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

// Returns the columns in which two ticks are not bit-identical.
std::string differing(const TickRecord& run, const TickRecord& again) {
  std::string names;
  for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
    if (column.has(kMeasuredTime)) continue;
    if (std::bit_cast<std::uint64_t>(column.get(run)) != std::bit_cast<std::uint64_t>(column.get(again)) &&
        !(std::isnan(column.get(run)) && std::isnan(column.get(again))))
      names += column.name + " ";
  }
  return run.bone_hash == again.bone_hash ? names : names + "bone";
}

TEST_F(ResumeRecordingTest, ContinuesBitIdenticallyFromRandomTicks) {
  record({{"barrier-shell", 1.5},
          {"barrier-shell", 1.0},
          {"point-shell", 1.0},
          {"point-shell", 1.0, 2},
          {"surface-points", 1.5},
          {"line-proxy", 1.5, 0},
          {"barrier-shell", 1.5}},
         250);
  std::mt19937 random(43);
  for (int n = 0; n < 20; ++n) {
    const std::size_t at = random() % ticks_.size();
    ResumedRecording resumed = resume_recording(scan_, recording_, ticks_[at].time_s);
    ASSERT_EQ(resumed.ticks, at + 1);
    EXPECT_EQ(resumed.session->volume().change_hash(), ticks_[at].bone_hash);
    std::size_t next = at + 1;
    // Repeats the original motion in the resumed session.
    for (; next < ticks_.size() && ticks_[next].session == ticks_[at].session && next < at + 50; ++next) {
      TickRecord now = tick(*resumed.session, static_cast<int>(next));
      now.session = ticks_[next].session;
      ASSERT_EQ(differing(ticks_[next], now), "") << "resumed at " << at << ", differs at " << next;
    }
    // Also replays the rest of the recording.
    next = at + 1;
    ReplayHooks hooks;
    hooks.on_tick = [&](const TickRecord&, const TickRecord& now) {
      const std::string what = differing(ticks_[next], now);
      EXPECT_EQ(what, "") << "resumed at " << at << ", differs at " << next;
      ++next;
      return what.empty();
    };
    replay_rest(resume_recording(scan_, recording_, ticks_[at].time_s), scan_, recording_, hooks);
    EXPECT_EQ(next, ticks_.size());
  }
}

TEST_F(ResumeRecordingTest, RefusesInvalidTimesOtherScansAndDifferingTicks) {
  record({{"point-shell", 1.5}}, 300);
  const auto refused = [&](const Recording& recording, double time_s) {
    return refusal([&] { resume_recording(scan_, recording, time_s); });
  };
  EXPECT_NE(refused(recording_, 0.5).find("has no tick at 0.5 s; choose a time from 0.000 to 0.300 s"),
            std::string::npos);
  EXPECT_NE(refused(recording_, -0.1).find("has no tick at -0.1 s"), std::string::npos);
  EXPECT_NE(refused(recording_, std::nan("")).find("has no tick"), std::string::npos);
  const Volume other = testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                                     testing_support::ball(Vec3::Zero(), 5.1));
  EXPECT_NE(refusal([&] { resume_recording(other, recording_, 0.1); }).find("another scan"),
            std::string::npos);
  Recording changed = recording_;
  changed.records[200].wrench.force_N.x() += 1e-9;
  EXPECT_NE(refused(changed, 0.25).find("differs from tick 200 on"), std::string::npos);
  EXPECT_EQ(refused(changed, 0.19), "");
}

TEST_F(ResumeRecordingTest, ReplaysBranchesAndRefusesBrokenOrCircularChains) {
  record({{"point-shell", 1.5}, {"barrier-shell", 1.5}}, 200);
  ResumedRecording resumed = resume_recording(scan_, recording_, 0.299);
  const auto write = [&](const char* name, const char* from, std::uint64_t after) {
    Recorder recorder(folder_ / name, recording_.description, Recorder::FirstSession::begins_when_announced);
    recorder.begin_session(0, {.continues_from = from, .continues_after = after});
    for (int n = 0; n < 120; ++n) {
      TickRecord record = tick(*resumed.session, 2000 + n);
      record.session = 0;
      recorder.push_waiting(record);
    }
    recorder.close();
  };
  write("b.h5", "a.h5", resumed.ticks);
  // A branch of the branch, from its end.
  write("c.h5", "b.h5", 0);
  write("lost.h5", "a.h5", 401);
  write("round.h5", "round.h5", 10);
  write("there.h5", "back.h5", 10);
  write("back.h5", "there.h5", 10);
  for (const auto& [name, ticks] : {std::pair{"b.h5", 420u}, {"c.h5", 540u}}) {
    const Recording whole = read_recording_chain(folder_ / name);
    EXPECT_EQ(whole.records.size(), ticks);
    EXPECT_EQ(whole.sessions.size(), 2u);
    const Verification verified = verify_recording(scan_, whole);
    EXPECT_FALSE(verified.difference) << name << ": " << verified.difference->sentence();
    EXPECT_EQ(verified.ticks, ticks);
  }
  EXPECT_NE(refusal([&] {
              read_recording_chain(folder_ / "lost.h5");
            }).find("tick 401 of a.h5, which has only 400"),
            std::string::npos);
  for (const char* round : {"round.h5", "there.h5"})
    EXPECT_NE(refusal([&] { read_recording_chain(folder_ / round); }).find("or itself"), std::string::npos);
}

TEST_F(ResumeRecordingTest, FindsTheBoneAtAnyTickWithinTheMemoryLimit) {
  record({{"point-shell", 1.5}, {"point-shell", 2.0}, {"point-shell", 1.0, 1}, {"point-shell", 1.5}}, 2600);
  const std::size_t all = RecordedBone(scan_, recording_).bytes();
  // Each lower limit leaves fewer checkpoints.
  std::size_t before = 1000;
  for (const std::size_t max_bytes : {all, all / 2, all / 3}) {
    RecordedBone bone(scan_, recording_, max_bytes);
    EXPECT_LE(bone.bytes(), max_bytes);
    EXPECT_LT(bone.checkpoints(), before);
    before = bone.checkpoints();
    EXPECT_EQ(bone.bone().change_hash(), ticks_.back().bone_hash);
    std::mt19937 random(7);
    Volume followed = bone.bone();
    const auto follow = [&](const VoxelBox& changed) {
      for_each(changed.bricks(DensityBlock::kVoxels), [&](const VoxelIndex& brick) {
        DensityBlock now(bone.bone().grid(), VoxelBox::of_brick(brick, DensityBlock::kVoxels).first);
        EditableVolume(followed).swap(now);
      });
    };
    for (int n = 0; n < 40; ++n) {
      const std::size_t at = random() % ticks_.size();
      bone.go_to(at + 1, follow);
      ASSERT_EQ(bone.ticks(), at + 1);
      ASSERT_EQ(bone.bone().change_hash(), ticks_[at].bone_hash) << "at " << at;
      ASSERT_EQ(followed.change_hash(), ticks_[at].bone_hash) << "a change was not told of, at " << at;
    }
    bone.go_to(0, follow);
    EXPECT_EQ(bone.bone().change_hash(), 0u);
  }
}

// Resets after a cut that no checkpoint contains; the new session lists no bricks.
TEST_F(ResumeRecordingTest, FindsTheBoneAfterAResetOfACutWithoutCheckpoint) {
  record({{"point-shell", 1.5}, {"point-shell", 1.0, 0}, {"point-shell", 1.0}}, 400);
  ASSERT_GT(ticks_[399].removed_mm3, 0);
  RecordedBone bone(scan_, recording_);
  for (std::size_t at = 0; at < ticks_.size(); at += 50) {
    bone.go_to(at + 1);
    ASSERT_EQ(bone.bone().change_hash(), ticks_[at].bone_hash) << "at " << at;
  }
}

}  // namespace
}  // namespace osteomill
