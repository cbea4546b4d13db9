#include <cmath>

#include <gtest/gtest.h>

#include "osteomill/base/temporary_folder.h"
#include "osteomill/recording/record_columns.h"
#include "osteomill/recording/recording.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/run_trials.h"

#include "tests/shapes.h"

namespace osteomill {
namespace {

class RecordedTrialTest : public ::testing::Test {
 protected:
  RecordedTrialTest()
      : bone_(testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                            testing_support::ball(Vec3::Zero(), 5))) {}

  TrialPlan plan_of(const TrialSettings& settings) const {
    return {bone_, {"a ball", 0}, {0.5, 1000}, place_entry(bone_, settings.tool, {}, {}), settings, ""};
  }

  Volume bone_;
};

// Changes each field to another value within its range.
template <typename Struct>
void change(Struct& s) {
  double n = 1;
  for (const Field<Struct>& field : fields_of<Struct>()) {
    const double usual = field.get(s);
    const double other = std::isfinite(usual) ? 1.0625 * usual + 0.001 * n : 3 + n;
    field.set(s, field.range == NumberRange::on_or_off() ? 1 - usual : other);
    EXPECT_TRUE(field.range.contains(field.get(s))) << field.name << field.option;
    ++n;
  }
}

template <typename Struct>
void expect_same(const Struct& restored, const Struct& made_with) {
  for (const Field<Struct>& field : fields_of<Struct>())
    EXPECT_EQ(field.get(restored), field.get(made_with)) << field.name << field.option;
}

// Returns the trial's settings as reconstructed from the recording alone.
TrialSettings settings_of(const RunDescription& run) {
  TrialSettings settings;
  static_cast<MillingSetup&>(settings) = session_settings(run, "a.h5").setup;
  settings.algorithm = algorithm_named(run.algorithm.name);
  settings.hand_and_device.handle.limits = settings.guard.limits;
  take_fields(run, "a.h5", settings.hand_and_device);
  settings.hand_and_device.seed = run.seed;
  return settings;
}

TEST_F(RecordedTrialTest, RestoresEveryFieldOfHandDeviceScriptAndSession) {
  TrialSettings settings;
  change<MillingSetup>(settings);
  change(settings.hand_and_device);
  settings.hand_and_device.seed = 77;
  settings.tick_s = 0.002;
  settings.algorithm = algorithm_named("line-proxy");
  settings.haptics.named = {{"line-proxy", "vertices", 60}};
  const RunDescription run = describe_trial(plan_of(settings), 60, kMilling);
  const TrialSettings restored = settings_of(run);
  expect_same<MillingSetup>(restored, settings);
  expect_same(restored.hand_and_device, settings.hand_and_device);
  EXPECT_EQ(restored.hand_and_device.seed, 77u);
  EXPECT_EQ(restored.tick_s, 0.002);
  EXPECT_EQ(setting_values(restored.algorithm, restored.haptics)[0].value, 60);
  EXPECT_EQ(session_settings(run, "a.h5").densities.surroundings, 0.5);
}

TEST_F(RecordedTrialTest, OtherTremorsKeepTheStiffnessAndChangeThePath) {
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = settings.hand_and_device.script.holding_s = 0.5;
  const TrialPlan plan = with_seed(plan_of(settings), 5);
  std::vector<double> paths_mm;
  for (const TrialPlan& other : trials_with_other_tremors(plan)) {
    EXPECT_EQ(other.settings.hand_and_device.hand.stiffness_N_per_mm,
              plan.settings.hand_and_device.hand.stiffness_N_per_mm);
    const MeasuredRun run = run_single_trial(StudyTest::milling, other).rows.front().run;
    EXPECT_EQ(run.seed, 5u);
    EXPECT_FALSE(run.is_study_hand());
    EXPECT_EQ(run.other_tremor, other.other_tremor);
    paths_mm.push_back(run.metrics.path_mm);
  }
  ASSERT_EQ(paths_mm.size(), 2u);
  EXPECT_NE(paths_mm[0], paths_mm[1]);
  EXPECT_NE(paths_mm[0], run_single_trial(StudyTest::milling, plan).rows.front().run.metrics.path_mm);
}

// The algorithms are exchanged in the first second, in which the force may jump.
TEST_F(RecordedTrialTest, ExcludesTheStartOfAHoldingAfterTheExchange) {
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = settings.hand_and_device.script.holding_s = 1.5;
  const TrialPlan plan = plan_of(settings);
  const std::vector<MeasuredRun> held = hold_in_one_hole(plan, {plan, plan});
  ASSERT_EQ(held.size(), 2u);
  EXPECT_NEAR(held.back().metrics.steps, 750, 1) << "half of it, as it is shorter than 2 s";
}

// The hand is in the loop: any difference in it would change what is felt and milled.
TEST_F(RecordedTrialTest, RerunFromARecordingIsBitIdentical) {
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = settings.hand_and_device.script.holding_s = 1.5;
  settings.hand_and_device.hand.push_N = 2;
  settings.cutting_reaction = true;
  const TrialPlan plan = with_seed(plan_of(settings), 5);
  const TemporaryFolder folder;
  const EntryPictures pictures(bone_, 1000, plan.entry, {}, false);
  const Recording recording = read_recording(record_trial(plan, pictures, folder.path(), {}).front());
  MillingTrial trial(bone_, plan.densities, plan.entry, settings_of(recording.description));
  ASSERT_GT(recording.records.size(), 1000u);
  EXPECT_GT(recording.records.back().removed_mm3, 0.1);
  for (const TickRecord& recorded : recording.records) {
    const TickRecord now = trial.tick().record;
    for (const Field<TickRecord>& column : fields_of<TickRecord>()) {
      if (column.has(kMeasuredTime)) continue;
      if (std::isnan(column.get(now)) && std::isnan(column.get(recorded))) continue;
      ASSERT_EQ(column.get(now), column.get(recorded)) << column.name << " at " << recorded.time_s << " s";
    }
  }
}

}  // namespace
}  // namespace osteomill
