#include "osteomill/recording/replay_recording.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/trajectory.h"
#include "osteomill/volume/density_block.h"
#include "osteomill/volume/density_grid.h"
#include "osteomill/volume/editable_volume.h"

#include "tests/shapes.h"
#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

using testing_support::TestFolder;

constexpr double kIsovalue = 500;

Volume fresh_bone(double radius_mm = 5) {
  return testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                       testing_support::ball(Vec3::Zero(), radius_mm));
}

// Returns session settings of which none has its default value.
SessionSettings settings_of_all(const AlgorithmDescription& algorithm) {
  return {{.algorithm = algorithm,
           .cutting = {.spindle_speed_rpm = 30000, .tangential_share = 0.2},
           .removal_rate_mm3_per_Ns = 3.0,
           .cutting_reaction = true,
           .vibration = {true, 0.1, 0.4},
           .guard = {.limits = {8, 300}, .passivity_controller = true}},
          {0, 1000}};
}

RunDescription description_of(const Volume& scan, const AlgorithmDescription& algorithm) {
  return describe_run(scan, {"ball", fingerprint_of(scan.grid())}, settings_of_all(algorithm), 0);
}

std::unique_ptr<MillingSession> make(std::shared_ptr<Volume> bone, const AlgorithmDescription& algorithm) {
  const auto [setup, densities] = settings_of_all(algorithm);
  return std::make_unique<MillingSession>(std::move(bone), densities, setup);
}

// Simulated hand on a ball of bone: presses and slides, rests, jumps, loses its pose, is placed elsewhere.
class Hand {
 public:
  TickRecord tick(MillingSession& session) {
    const int n = n_++;
    const double time_s = 1e-3 * n;
    const double dt_s = n % 7 == 0 ? 1.5e-3 : 1e-3;
    Pose pose = placed_ ? Pose{{6.5, 0, 0}, Quat::Identity()} : Pose{};
    if (!placed_) pose.position_mm = {0.002 * n, 0.1 * std::sin(0.05 * n), 7.0 - std::min(0.01 * n, 2.5)};
    pose.orientation = quaternion_from_rotation_vector({0.3 * std::sin(0.01 * n), 0.2, 0.1});
    if (n == 300) pose.position_mm.x() += 20;
    if (n == 320) pose.position_mm.y() = std::numeric_limits<double>::quiet_NaN();
    // The device sometimes delivers only part of the force.
    device_.put(pose, n % 50 < 40 ? 1 : 0.4, n < 560 || n > 565);
    if (n == 450) session.fade_out();
    if (n == 500) {
      placed_ = true;
      device_.put({{6.5, 0, 0}, Quat::Identity()});
      session.place();
    }
    return session.tick(
        device_, {.time_s = time_s, .dt_s = dt_s, .spindle_on = n % 90 < 80, .paused = n >= 350 && n < 380});
  }

 private:
  PosedDevice device_;
  int n_ = 0;
  bool placed_ = false;
};

std::string refusal(const Volume& scan, const Recording& recording) {
  try {
    verify_recording(scan, recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ReplayRecording, ReplaysEveryAlgorithmWithoutDifference) {
  const TestFolder folder;
  for (const AlgorithmDescription& algorithm : all_algorithms()) {
    const Volume scan = fresh_bone();
    const auto bone = std::make_shared<Volume>(scan);
    const auto session = make(bone, algorithm);
    Recorder recorder(folder / "run.h5", description_of(scan, algorithm));
    Hand hand;
    std::set<WrenchFault> faults;
    for (int n = 0; n < 620; ++n) {
      const TickRecord record = hand.tick(*session);
      faults.insert(record.fault);
      recorder.push_waiting(record);
    }
    recorder.close();
    EXPECT_GE(faults.size(), 4u) << "the hand is to meet everything that a guard does";
    const Recording recording = read_recording(folder / "run.h5");
    ASSERT_GT(recording.records.back().removed_mm3, 0.05) << algorithm.id.name;
    const Verification verified = verify_recording(scan, recording);
    EXPECT_FALSE(verified.difference)
        << algorithm.id.name << " at " << verified.difference->record << ": " << verified.difference->what;
    EXPECT_EQ(verified.ticks, 620u);
    EXPECT_EQ(verified.compared_bones, 7u) << "every hundredth, and the last";
    EXPECT_EQ(recording.bone_hashes.back(), (BoneHash{619, bone->change_hash()}));
  }
}

// Recording starts after a first session has milled and continues across changes of algorithm, a reset and
// another isovalue.
TEST(ReplayRecording, ReplaysSeveralSessionsOnPreviouslyMilledBone) {
  const TestFolder folder;
  const Volume scan = fresh_bone();
  const auto bone = std::make_shared<Volume>(scan);
  const AlgorithmDescription& first = algorithm_named("surface-points");
  auto session = make(bone, first);
  Hand hand;
  for (int n = 0; n < 200; ++n) hand.tick(*session);
  ASSERT_GT(session->removed_mm3(), 0.1);

  struct Step {
    const char* algorithm;
    double isovalue;
    bool reset;
  };
  Recorder recorder(folder / "run.h5", description_of(scan, algorithm_named("point-shell")),
                    Recorder::FirstSession::begins_when_announced);
  std::uint32_t number = 3;
  std::shared_ptr<Volume> now = bone;
  for (const Step& step : {Step{"point-shell", kIsovalue, false}, Step{"barrier-shell", kIsovalue, false},
                           Step{"line-proxy", kIsovalue, true}, Step{"point-shell", 300, false}}) {
    const AlgorithmDescription& algorithm = algorithm_named(step.algorithm);
    const double removed_mm3 = step.reset ? 0 : session->removed_mm3();
    now = std::make_shared<Volume>(step.reset ? scan : *now);
    EditableVolume(*now).set_isovalue(step.isovalue);
    auto next = make(now, algorithm);
    next->count_removed_from(removed_mm3);
    const SessionHandover before = session->handover();
    next->resume_from(before);
    RunDescription run = description_of(scan, algorithm);
    run.isovalue = step.isovalue;
    recorder.begin_session(
        number, {std::move(run), before, removed_mm3, differing_blocks(now->grid(), scan.grid()), ""});
    session = std::move(next);
    for (int n = 0; n < 130; ++n) {
      TickRecord record = hand.tick(*session);
      record.session = number;
      recorder.push_waiting(record);
    }
    ++number;
  }
  recorder.close();
  const Recording recording = read_recording(folder / "run.h5");
  ASSERT_EQ(recording.sessions.size(), 4u);
  EXPECT_FALSE(recording.sessions[0].start.bricks.empty());
  EXPECT_TRUE(recording.sessions[2].start.bricks.empty());
  EXPECT_EQ(recording.sessions[3].first, 390u);
  EXPECT_EQ(recording.sessions[3].start.run.isovalue, 300);
  EXPECT_EQ(recording.sessions[1].start.run.algorithm, "barrier-shell");
  EXPECT_EQ(recording.records[130].session, 1u);
  const Verification verified = verify_recording(scan, recording);
  EXPECT_FALSE(verified.difference) << verified.difference->record << ": " << verified.difference->what;
  EXPECT_EQ(verified.ticks, 520u);
}

class ReplayRecordingTest : public ::testing::Test {
 protected:
  ReplayRecordingTest() {
    const auto session = make(std::make_shared<Volume>(scan_), algorithm_);
    Recorder recorder(folder_ / "a.h5", description_of(scan_, algorithm_));
    Recorder rest(folder_ / "b.h5", description_of(scan_, algorithm_),
                  Recorder::FirstSession::begins_when_announced);
    rest.begin_session(0, {.continues_from = "a.h5"});
    Hand hand;
    for (int n = 0; n < 250; ++n) recorder.push_waiting(hand.tick(*session));
    for (int n = 0; n < 150; ++n) rest.push_waiting(hand.tick(*session));
    recorder.close();
    rest.close();
  }

  TestFolder folder_;
  Volume scan_ = fresh_bone();
  AlgorithmDescription algorithm_ = algorithm_named("point-shell");
};

TEST_F(ReplayRecordingTest, ReportsTheFirstDifferingTick) {
  const Recording recording = read_recording(folder_ / "a.h5");
  Recording other = recording;
  other.records[200].wrench.force_N.y() += 0.25;
  Verification verified = verify_recording(scan_, other);
  ASSERT_TRUE(verified.difference);
  EXPECT_EQ(verified.difference->record, 200u);
  EXPECT_EQ(verified.difference->time_s, other.records[200].time_s);
  EXPECT_NE(verified.difference->what.find("force_y_N"), std::string::npos) << verified.difference->what;
  EXPECT_NE(verified.difference->what.find("difference -0.25"), std::string::npos)
      << verified.difference->what;

  other = recording;
  other.bone_hashes[1].hash += 1;
  verified = verify_recording(scan_, other);
  ASSERT_TRUE(verified.difference);
  EXPECT_EQ(verified.difference->record, 199u);
  EXPECT_NE(verified.difference->what.find("bone"), std::string::npos);

  other = recording;
  other.records[150].X_WD.position_mm.z() += 1e-3;
  verified = verify_recording(scan_, other);
  ASSERT_TRUE(verified.difference);
  EXPECT_EQ(verified.difference->record, 150u);
}

TEST_F(ReplayRecordingTest, ReplaysAChainOfContinuedRecordings) {
  const Recording rest = read_recording(folder_ / "b.h5");
  EXPECT_NE(refusal(scan_, rest).find("continues a.h5"), std::string::npos);
  const Recording whole = read_recording_chain(folder_ / "b.h5");
  EXPECT_EQ(whole.records.size(), 400u);
  const Verification verified = verify_recording(scan_, whole);
  EXPECT_FALSE(verified.difference) << verified.difference->what;
  EXPECT_EQ(verified.ticks, 400u);
  EXPECT_EQ(verified.compared_bones, 3u + 2u);
}

TEST_F(ReplayRecordingTest, RefusesOtherScansLostTicksAndUnknownAlgorithms) {
  const Recording recording = read_recording(folder_ / "a.h5");
  EXPECT_NE(refusal(fresh_bone(5.1), recording).find("another scan (ball)"), std::string::npos);
  Recording other = recording;
  other.dropped = 2;
  EXPECT_NE(refusal(scan_, other).find("lost 2 ticks"), std::string::npos);
  other = recording;
  other.sessions.clear();
  EXPECT_NE(refusal(scan_, other).find("holds no ticks"), std::string::npos);
  other = recording;
  other.sessions[0].start.run.algorithm.name = "somebody-s";
  EXPECT_NE(refusal(scan_, other).find("somebody-s is not known"), std::string::npos);
  other = recording;
  other.sessions[0].start.run.tool.burr_radius_mm = -1;
  EXPECT_NE(refusal(scan_, other).find("cannot be replayed"), std::string::npos);
}

TEST_F(ReplayRecordingTest, ReplaysTheSameMotionWithAnotherAlgorithm) {
  const Recording recording = read_recording(folder_ / "a.h5");
  ReplayHooks hooks;
  hooks.transform_description = [](RunDescription run) {
    set_session_settings(run, settings_of_all(algorithm_named("line-proxy")), 0);
    return run;
  };
  bool begun = false;
  hooks.on_session = [&](const SessionStart& start, const MillingSession&) {
    begun = start.run.algorithm == "line-proxy";
  };
  std::size_t ticks = 0, other = 0;
  hooks.on_tick = [&](const TickRecord& recorded, const TickRecord& now) {
    EXPECT_EQ(recorded.X_WD.position_mm, now.X_WD.position_mm);
    other += recorded.wrench.force_N != now.wrench.force_N ? 1u : 0u;
    return ++ticks < 240;
  };
  replay_recording(scan_, recording, hooks);
  EXPECT_TRUE(begun);
  EXPECT_EQ(ticks, 240u);
  EXPECT_GT(other, 20u);
}

}  // namespace
}  // namespace osteomill
