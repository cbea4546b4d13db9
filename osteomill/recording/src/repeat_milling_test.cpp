#include <algorithm>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/haptics/algorithms.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/recording/replay_recording.h"
#include "osteomill/recording/run_description.h"
#include "osteomill/session/milling_session.h"
#include "osteomill/session/trajectory.h"

#include "tests/shapes.h"
#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

using testing_support::TestFolder;

constexpr BoneDensities kDensities{0, 1000};
const MillingSetup kSetup{.algorithm = algorithm_named("point-shell"),
                          .removal_rate_mm3_per_Ns = 3.0,
                          .cutting_reaction = true,
                          .guard = GuardSettings::for_simulation()};

Volume fresh_bone(double radius_mm = 5) {
  return testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                       testing_support::ball(Vec3::Zero(), radius_mm));
}

RunDescription description_of(const Volume& bone) {
  RunDescription run = testing_support::sample_description();
  run.dims = bone.geometry().dims;
  run.spacing_mm = bone.geometry().spacing_mm;
  run.isovalue = bone.isovalue();
  run.tool = {};
  set_session_settings(run, {kSetup, kDensities}, 0);
  return run;
}

struct Milled {
  Recording recording;
  Volume bone;
};

// Records a burr pressing down with the spindle alternately on and off, in ticks of two lengths.
Milled mill_and_record(const TestFolder& folder) {
  MillingSession session(std::make_shared<Volume>(fresh_bone()), kDensities, kSetup);
  Recorder recorder(folder / "run.h5", description_of(session.volume()));
  PosedDevice device;
  double time_s = 0;
  for (int n = 0; n < 900; ++n) {
    Pose pose;
    pose.position_mm = {0.001 * n, 0, 7.0 - std::min(0.004 * n, 2.0)};
    device.put(pose);
    const double dt_s = n % 2 == 0 ? 1e-3 : 0.7e-3;
    recorder.push_waiting(
        session.tick(device, {.time_s = time_s, .dt_s = dt_s, .spindle_on = n % 300 < 250}));
    time_s += dt_s;
  }
  recorder.close();
  return {read_recording(folder / "run.h5"), session.volume()};
}

std::string refusal(Volume bone, const Recording& recording) {
  try {
    repeat_milling(bone, recording);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(RepeatMilling, ReproducesTheRecordedBoneExactly) {
  const TestFolder folder;
  const Milled milled = mill_and_record(folder);
  ASSERT_GT(milled.recording.records.back().removed_mm3, 1);
  Volume again = fresh_bone();
  repeat_milling(again, milled.recording);
  EXPECT_EQ(again.grid().densities(), milled.bone.grid().densities());
  EXPECT_NE(again.grid().densities(), fresh_bone().grid().densities());
}

TEST(RepeatMilling, RefusesOtherScansLostTicksAndInvalidSettings) {
  const TestFolder folder;
  const Recording recording = mill_and_record(folder).recording;

  Recording other = recording;
  other.description.dims[1] = 61;
  EXPECT_NE(refusal(fresh_bone(), other).find("another scan"), std::string::npos);
  other = recording;
  other.description.spacing_mm.z() = 0.3;
  EXPECT_NE(refusal(fresh_bone(), other).find("another scan"), std::string::npos);
  EXPECT_NE(refusal(fresh_bone(5.1), recording).find("another scan"), std::string::npos);
  other = recording;
  other.dropped = 3;
  EXPECT_NE(refusal(fresh_bone(), other).find("lost 3 ticks"), std::string::npos);
  other = recording;
  other.records.erase(other.records.begin(), other.records.begin() + 800);
  EXPECT_NE(refusal(fresh_bone(), other).find("continues other milling"), std::string::npos);
  other = recording;
  const auto removal_rate = [](RunDescription& run) {
    return std::ranges::find(run.settings, "milling.removal_rate", &RunSetting::key);
  };
  RunDescription& lacking = other.sessions[0].start.run;
  lacking.settings.erase(removal_rate(lacking));
  EXPECT_NE(refusal(fresh_bone(), other).find("'milling.removal_rate'"), std::string::npos);
  other = recording;
  removal_rate(other.sessions[0].start.run)->value = -1.0;
  EXPECT_NE(refusal(fresh_bone(), other).find("cannot be replayed"), std::string::npos);
  EXPECT_EQ(refusal(fresh_bone(), recording), "");
}

}  // namespace
}  // namespace osteomill
