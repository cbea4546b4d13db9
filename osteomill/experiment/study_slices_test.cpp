#include "osteomill/experiment/study_slices.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "osteomill/files/input_error.h"
#include "osteomill/files/temporary_folder.h"

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
  const std::size_t columns = columns_of(StudyTest::milling).size();
  for (std::size_t n = 0; n < record.size_of(number); ++n) {
    for (std::size_t part = 0; part < 2; ++part) {
      std::vector<double> values(columns, 0.1 * static_cast<double>(n + part));
      values.back() = kNotMeasured;
      slice.rows.push_back({record.first_of(number) + n, part, values, part == 0 ? "" : "too shallow, lost"});
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
    EXPECT_EQ(back->rows[n].not_reached, slice.rows[n].not_reached);
    EXPECT_EQ(back->rows[n].values.front(), slice.rows[n].values.front());
    EXPECT_TRUE(std::isnan(back->rows[n].values.back()));
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

// Columns, and what follows from others, survive a slice.
TEST(StudySlices, AMillingRowIsTheSameAfterASlice) {
  StudyRow row;
  row.stiffness_N_per_m = 700;
  row.run.phase = "holding";
  row.run.metrics.force_N = {2, 3, 0.5, 0.1, 0.25};
  row.run.metrics.removed_mm3 = 4;
  row.run.not_reached = "lost";
  const StudyRow back = milling_row(as_row(row));
  EXPECT_EQ(back.stiffness_N_per_m, 700);
  EXPECT_EQ(back.run.phase, "holding");
  EXPECT_EQ(back.run.metrics.force_N.max, 3);
  EXPECT_EQ(back.run.metrics.force_N.hp_share, 0.25);
  EXPECT_EQ(back.run.metrics.removed_mm3, 4);
  EXPECT_EQ(back.run.not_reached, "lost");
}

}  // namespace
}  // namespace osteomill
