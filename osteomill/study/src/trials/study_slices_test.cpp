#include "osteomill/study/study_slices.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/stat.h>

#include "osteomill/base/file_lock.h"
#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"
#include "osteomill/recording/recording.h"
#include "osteomill/study/paper.h"
#include "osteomill/study/run_groups.h"
#include "osteomill/study/run_trials.h"

#include "tests/shapes.h"

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

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// Flips one bit of one value.
void damage(const fs::path& path) {
  std::string bytes = bytes_of(path);
  const double value = 0.1;
  const std::size_t at = bytes.find(std::string(reinterpret_cast<const char*>(&value), sizeof(value)));
  ASSERT_NE(at, std::string::npos);
  bytes[at] = static_cast<char>(bytes[at] ^ 1);
  write_bytes(path, bytes);
}

TEST(StudySlices, LastSliceHoldsTheRemainingTrials) {
  const StudyRecord record = sample_record();
  EXPECT_EQ(record.slices(), 3u);
  EXPECT_EQ(record.size_of(1), 2u);
  EXPECT_EQ(record.size_of(2), 1u);
}

TEST(StudySlices, RowsRoundTripUnchanged) {
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

TEST(StudySlices, LockedSliceIsNeitherDoneNorMissing) {
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), sample_record()};
  for (std::size_t n = 0; n < 3; ++n) write_slice(study, sample_slice(study.record, n));
  EXPECT_NO_THROW(require_none_locked(study_status(study)));
  const auto lock = FileLock::try_lock(slice_path(folder.path(), 1));
  const StudyStatus status = study_status(study);
  EXPECT_EQ(status.locked, std::vector<fs::path>{slice_path(folder.path(), 1)});
  EXPECT_TRUE(status.missing.empty() && status.damaged.empty());
  EXPECT_EQ(status.trials_done, 3u);
  EXPECT_THROW(require_none_locked(status), InputError);
  EXPECT_THROW(read_slice(study, 1), InputError);
}

TEST(StudySlices, TruncatedDamagedOrForeignSlicesAreMissing) {
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

TEST(StudySlices, RecordRoundTripsAndInvalidRecordIsRefused) {
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

// Changes a few bytes in various ways; --gtest_repeat and --gtest_shuffle give different ones each time.
std::string mutated(std::string bytes, std::mt19937& random) {
  const auto below = [&](std::size_t end) { return random() % end; };
  for (std::size_t n = 1 + below(3); n > 0; --n) {
    const std::size_t at = below(bytes.size()), length = 1 + below(8);
    const std::size_t kind = below(4);
    for (std::size_t k = at; k < std::min(bytes.size(), at + length); ++k) {
      if (kind == 0) bytes[k] = static_cast<char>(random());
      if (kind == 1) bytes[k] = static_cast<char>(0xff);
      if (kind == 2) bytes[k] = 0;
    }
    if (kind == 3) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
  }
  return bytes;
}

void expect_end(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
  }
}

// HDF5 itself follows an invalid address and crashes the program.
TEST(StudySlices, CorruptFilesDoNotCrashTheProgram) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "HDF5 reads beyond its memory in the child, and loses some when it refuses";
#endif
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), sample_record()};
  write_study_record(folder.path(), study.record);
  write_slice(study, sample_slice(study.record, 0));
  const fs::path slice = slice_path(folder.path(), 0), record = folder / "study.h5";
  const std::string slice_bytes = bytes_of(slice), record_bytes = bytes_of(record);
  for (std::size_t at = 0; at + 8 <= slice_bytes.size(); at += 8) {
    std::string bytes = slice_bytes;
    write_bytes(slice, bytes.replace(at, 8, 8, static_cast<char>(0xff)));
    expect_end([&] { read_slice(study, 0); });
  }
  std::mt19937 random(static_cast<unsigned>(::testing::UnitTest::GetInstance()->random_seed()));
  for (int n = 0; n < 500; ++n) {
    write_bytes(slice, mutated(slice_bytes, random));
    expect_end([&] { read_slice(study, 0); });
    write_bytes(record, mutated(record_bytes, random));
    expect_end([&] { read_study_record(folder.path()); });
  }
}

// Returns whether the slice's file can be read after `change`.
bool is_read_after(const std::function<void(hid_t)>& change) {
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), sample_record()};
  write_slice(study, sample_slice(study.record, 0));
  const hid_t file = H5Fopen(slice_path(folder.path(), 0).c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  change(file);
  H5Fclose(file);
  return read_slice(study, 0).has_value();
}

TEST(StudySlices, NothingIsReadFromAnotherFile) {
  EXPECT_TRUE(is_read_after([](hid_t) {}));
  EXPECT_FALSE(is_read_after([](hid_t file) {
    H5Ldelete(file, "not_reached", H5P_DEFAULT);
    H5Lcreate_external("other.h5", "/not_reached", file, "not_reached", H5P_DEFAULT, H5P_DEFAULT);
  }));
  EXPECT_FALSE(is_read_after([](hid_t file) {
    hsize_t size = 0;
    const hid_t old = H5Dopen2(file, "not_reached", H5P_DEFAULT), space = H5Dget_space(old);
    H5Sget_simple_extent_dims(space, &size, nullptr);
    H5Dclose(old);
    H5Ldelete(file, "not_reached", H5P_DEFAULT);
    const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_external(layout, "/etc/passwd", 0, size);
    H5Dclose(H5Dcreate2(file, "not_reached", H5T_NATIVE_UCHAR, space, H5P_DEFAULT, layout, H5P_DEFAULT));
    H5Pclose(layout);
    H5Sclose(space);
  }));
}

TEST(StudySlices, RejectsPipesWithoutBlocking) {
  const TemporaryFolder folder;
  const StudyFolder study{folder.path(), sample_record()};
  ASSERT_EQ(::mkfifo(slice_path(folder.path(), 0).c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder / "study.h5").c_str(), 0600), 0);
  EXPECT_FALSE(read_slice(study, 0));
  EXPECT_THROW(read_study_record(folder.path()), InputError);
}

bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

// Compares each figure of a trial, from the slice's file and from recordings of the same trial.
TEST(StudySlices, RowEqualsRowMeasuredFromRecording) {
  const Volume bone = testing_support::shape_volume(testing_support::centred_cube(60, 0.25),
                                                    testing_support::ball(Vec3::Zero(), 5));
  TrialSettings settings;
  settings.hand_and_device.script.milling_s = settings.hand_and_device.script.holding_s = 1.5;
  settings.hand_and_device.seed = 3;
  const TrialPlan plan =
      with_seed({bone, {"a ball", 0}, {0, 1000}, place_entry(bone, settings.tool, {}, {}), settings, ""}, 3);
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
    const TrialRow measured{.part = part, .run = measured_phase(recording)};
    const TrialRow& row = slice->rows[part];
    EXPECT_EQ(row.run.phase, measured.run.phase);
    EXPECT_EQ(row.run.not_reached, measured.run.not_reached);
    std::size_t compared = 0;
    for (const Field<TrialRow>& column : columns_of(StudyTest::milling)) {
      if (column.has(kMachineDependent)) continue;
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
