#include "osteomill/experiment/study_slices.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/shapes.h"
#include <gtest/gtest.h>

#include "osteomill/experiment/paper.h"
#include "osteomill/experiment/run_trials.h"
#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/report/run_groups.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

StudyRecord sample_record() {
  return {.study_hash = 1,
          .program_hash = 2,
          .scans_from = "/here",
          .trials = 5,
          .trials_a_slice = 2,
          .bones = {{"scan=a", 3}}};
}

Slice sample_slice(const StudyRecord& record, std::size_t number) {
  Slice slice{number, {}, 1.5};
  for (std::size_t n = 0; n < record.size_of(number); ++n) {
    for (std::size_t part = 0; part < 2; ++part) {
      TrialRow row{.trial = record.first_of(number) + n, .part = part};
      for (const Field<TrialRow>& column : columns_of(StudyTest::milling))
        column.set(row, 0.1 * static_cast<double>(n + part));
      row.run.metrics.contacts_mean = kNotMeasured;
      row.run.not_reached = part == 0 ? "" : "too shallow, lost";
      slice.rows.push_back(row);
    }
  }
  return slice;
}

// One bit of one value.
void damage(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const double value = 0.1;
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof(value)));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(StudySlices, TheLastHasWhatIsLeft) {
  const StudyRecord record = sample_record();
  EXPECT_EQ(record.slices(), 3u);
  EXPECT_EQ(record.size_of(1), 2u);
  EXPECT_EQ(record.size_of(2), 1u);
}

TEST(StudySlices, RowsComeBackAsTheyWere) {
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), sample_record()};
  const Slice slice = sample_slice(study.record, 1);
  write_slice(study, slice);
  const auto back = read_slice(study, 1);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->cpu_s, 1.5);
  ASSERT_EQ(back->rows.size(), 4u);
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(back->rows[n].trial, slice.rows[n].trial);
    EXPECT_EQ(back->rows[n].part, slice.rows[n].part);
    EXPECT_EQ(back->rows[n].run.not_reached, slice.rows[n].run.not_reached);
    EXPECT_EQ(back->rows[n].run.phase, n % 2 == 0 ? kMilling : kHolding);
    for (const Field<TrialRow>& column : columns_of(StudyTest::milling)) {
      if (column.name == "contacts_mean") continue;
      EXPECT_EQ(column.get(back->rows[n]), column.get(slice.rows[n])) << column.name;
    }
    EXPECT_TRUE(std::isnan(back->rows[n].run.metrics.contacts_mean));
  }
}

TEST(StudySlices, WhatIsCutShortDamagedOrOfAnotherStudyIsMissing) {
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), sample_record()};
  for (std::size_t n = 0; n < 3; ++n) write_slice(study, sample_slice(study.record, n));
  StudyStatus status = study_status(study);
  EXPECT_TRUE(status.missing.empty());
  EXPECT_EQ(status.trials_done, 5u);
  EXPECT_EQ(status.cpu_s, 4.5);
  fs::resize_file(slice_path(folder.path(), 0), fs::file_size(slice_path(folder.path(), 0)) - 100);
  damage(slice_path(folder.path(), 1));
  status = study_status(study);
  EXPECT_EQ(status.missing, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(status.damaged.size(), 2u);
  EXPECT_EQ(status.trials_done, 1u);
  StudyFolder other = study;
  other.record.bones.front().second = 4;
  EXPECT_FALSE(read_slice(other, 2));
  fs::copy_file(slice_path(folder.path(), 2), slice_path(folder.path(), 1),
                fs::copy_options::overwrite_existing);
  EXPECT_FALSE(read_slice(study, 1));
}

TEST(StudySlices, ARecordComesBackAndNoneIsNone) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_study_record(folder.path()));
  write_study_record(folder.path(), sample_record());
  const auto back = read_study_record(folder.path());
  ASSERT_TRUE(back);
  EXPECT_EQ(back->hash(), sample_record().hash());
  EXPECT_EQ(back->scans_from, "/here");
  std::ofstream(folder / "study.h5") << "hello";
  EXPECT_THROW(read_study_record(folder.path()), InputError);
}

bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

// A trial of a study and the same trial in recordings: each figure, from the slice's file and from the
// recordings'.
TEST(StudySlices, ARowEqualsTheRowMeasuredFromItsRecording) {
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 5));
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = settings.hand_and_device.script.holding_s = 1.5;
  settings.hand_and_device.seed = 3;
  const TrialPlan plan =
      with_seed({bone, "a ball", {0, 1000}, place_entry(bone, settings.tool, {}, {}), settings, ""}, 3);
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), {.trials = 1, .trials_a_slice = 1}};
  write_slice(study, run_slice(study, 0, {plan}, 1, {}));
  const auto slice = read_slice(study, 0);
  ASSERT_TRUE(slice);
  const EntryPictures pictures(bone, 1000, plan.entry, {}, false);
  const std::vector<fs::path> recorded = record_trial(plan, pictures, folder.path(), {});
  ASSERT_EQ(recorded.size(), slice->rows.size());
  for (std::size_t part = 0; part < recorded.size(); ++part) {
    const Recording recording = read_recording(recorded[part]);
    const TrialRow measured{.part = part, .run = measured_run(recording, phase_metrics(recording))};
    const TrialRow& row = slice->rows[part];
    EXPECT_EQ(row.run.phase, measured.run.phase);
    EXPECT_EQ(row.run.not_reached, measured.run.not_reached);
    std::size_t compared = 0;
    for (const Field<TrialRow>& column : columns_of(StudyTest::milling)) {
      if (column.has(kOfTheMachine)) continue;
      EXPECT_TRUE(same_number(column.get(row), column.get(measured)))
          << column.name << ": " << column.get(row) << " in the study, " << column.get(measured);
      ++compared;
    }
    EXPECT_GT(compared, 25u);
    EXPECT_GT(row.run.metrics.contact.any, 0.1) << "enough to be measured";
    EXPECT_NE(row.run.metrics.contact.torque, row.run.metrics.contact.any) << "each is measured for itself";
  }
}

}  // namespace
}  // namespace osteomill
