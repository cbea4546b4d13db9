#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/recording/hdf5.h"
#include "osteomill/recording/recorder.h"
#include "osteomill/recording/recording.h"

#include "recording_file.h"
#include "tests/support/recording_samples.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;
using namespace testing_support;

void write_sample(const fs::path& path, int ticks) {
  Recorder recorder(path, sample_description());
  for (int tick = 0; tick < ticks; ++tick) recorder.push_waiting(sample_record(tick));
  recorder.add_picture("before", {1, 2, 3});
  recorder.close();
}

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void expect_refused(const fs::path& path, const std::string& reason) {
  try {
    read_recording(path);
    ADD_FAILURE() << path << " was read";
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_TRUE(what.starts_with(path.string() + ": ")) << what;
    EXPECT_NE(what.find(reason), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

class ChangedRecording : public ::testing::Test {
 protected:
  void SetUp() override { write_sample(path_, 1500); }

  void change(const std::function<void(hid_t file)>& how) {
    const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    how(file);
    ASSERT_GE(H5Fclose(file), 0);
    remove_seal();
  }
  // Removes the checksum line, as in a file rewritten by another program.
  void remove_seal() {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file << std::string(kUserBlockBytes, '\0');
  }
  // Writes the checksum in another process, so that the file does not count as our own.
  void seal_elsewhere() {
    const ::pid_t child = ::fork();
    if (child == 0) {
      write_checksum(path_);
      ::_exit(0);
    }
    ::waitpid(child, nullptr, 0);
  }
  static void set_number(hid_t file, const char* attribute, std::uint64_t value) {
    const hid_t a = H5Aopen(file, attribute, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(a, H5T_NATIVE_UINT64, &value), 0);
    H5Aclose(a);
  }
  static void set_rows(hid_t file, const char* column, hsize_t rows) {
    const hid_t dataset = H5Dopen2(file, column, H5P_DEFAULT);
    ASSERT_GE(H5Dset_extent(dataset, &rows), 0);
    H5Dclose(dataset);
  }

  TestFolder folder_;
  fs::path path_ = folder_ / "run.h5";
};

TEST_F(ChangedRecording, IsRefusedWithAnUnsupportedVersion) {
  change([](hid_t file) { set_number(file, "osteomill_recording_version", 4); });
  expect_refused(path_, "is a recording of version 4; this program reads versions 5 and 6");
}

TEST_F(ChangedRecording, IsRefusedWithAnInvalidOrMissingSession) {
  change([](hid_t file) {
    const hid_t session = H5Gopen2(file, "sessions/0", H5P_DEFAULT);
    set_number(session, "row", 5);
    H5Gclose(session);
  });
  expect_refused(path_, "'sessions/0' begins at a wrong row");
  change([](hid_t file) { H5Ldelete(file, "sessions/0", H5P_DEFAULT); });
  expect_refused(path_, "has ticks without a session");
}

TEST_F(ChangedRecording, IsRefusedNamingAMissingColumn) {
  change([](hid_t file) { H5Ldelete(file, "columns/torque_y_Nmm", H5P_DEFAULT); });
  expect_refused(path_, "no column 'columns/torque_y_Nmm'");
}

// In recordings of programs without held-back hands, every hand was driven.
TEST_F(ChangedRecording, IsReadWithDefaultsForNewerFields) {
  change([](hid_t file) {
    H5Ldelete(file, "columns/driven", H5P_DEFAULT);
    H5Ldelete(file, "columns/no_go_distance_mm", H5P_DEFAULT);
    H5Adelete_by_name(file, "sessions/0", "held_back", H5P_DEFAULT);
  });
  const Recording read = read_recording(path_);
  ASSERT_EQ(read.records.size(), 1500u);
  for (const TickRecord& record : read.records) {
    ASSERT_TRUE(record.driven);
    ASSERT_TRUE(std::isnan(record.no_go_distance_mm));
  }
  EXPECT_FALSE(read.sessions.front().start.handover.held_back);
}

TEST_F(ChangedRecording, IsRefusedWithColumnsOfUnequalLength) {
  change([](hid_t file) { set_rows(file, "columns/force_x_N", 1499); });
  expect_refused(path_, "'columns/force_x_N' has 1499 rows");
}

TEST_F(ChangedRecording, IsCutToTheShortestColumnIfUnfinished) {
  change([](hid_t file) {
    set_number(file, "complete", 0);
    set_rows(file, "columns/force_x_N", 1499);
  });
  const Recording read = read_recording(path_);
  EXPECT_FALSE(read.complete);
  ASSERT_EQ(read.records.size(), 1499u);
  EXPECT_TRUE(same_bits(read.records.back(), sample_record(1498)));
}

TEST_F(ChangedRecording, IsRefusedWithMoreRowsThanTheFileCanHold) {
  change([](hid_t file) { set_rows(file, "columns/time_s", hsize_t{1} << 50); });
  expect_refused(path_, "more than the file can hold");
}

TEST_F(ChangedRecording, IsRefusedNamingAMissingOrMistypedAttribute) {
  change([](hid_t file) { H5Adelete(file, "isovalue"); });
  expect_refused(path_, "no attribute 'isovalue'");
  change([](hid_t file) { H5Arename(file, "seed", "isovalue"); });
  expect_refused(path_, "'isovalue' has the wrong type");
}

TEST_F(ChangedRecording, IsRefusedWithAnInvalidDescription) {
  const auto reals = [this](const char* name, std::vector<double> values, const std::string& reason) {
    const std::string sound = bytes_of(path_);
    change([&](hid_t file) {
      H5Adelete(file, name);
      Attributes(path_, file).put_reals(name, values);
    });
    expect_refused(path_, reason);
    write_bytes(path_, sound);
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  reals("isovalue", {kNan}, "'isovalue' is not finite");
  reals("spacing_mm", {1, 1e300, 1}, "'spacing_mm' is not finite or exceeds 1e12");
  reals("origin_mm", {0, kInfinity, 0}, "'origin_mm' is not finite");
  reals("spacing_mm", {1, kNan, 1}, "'spacing_mm' is not finite");
  reals("spacing_mm", {1, 0, 1}, "'spacing_mm' is not three positive numbers");
  reals("axis_j", {1, 0, 0}, "axes are not orthonormal");
  reals("burr_radius_mm", {-1}, "the burr's radius (mm) must be a positive number");
  reals("tick_period_s", {0}, "'tick_period_s' is not a positive number");
  change([this](hid_t file) {
    H5Adelete(file, "dims");
    Attributes(path_, file).put("dims", std::array{16, 0, 16});
  });
  expect_refused(path_, "'dims' is not a valid scan size");
}

TEST_F(ChangedRecording, IsRefusedWithAColumnValueOutOfRange) {
  const auto fill = [this](const char* column, double value) {
    change([&](hid_t file) {
      const hid_t dataset = H5Dopen2(file, column, H5P_DEFAULT);
      const std::vector<double> values(1500, value);
      H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
      H5Dclose(dataset);
    });
  };
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  fill("columns/device_x_mm", kNan);
  EXPECT_EQ(read_recording(path_).records.size(), 1500u);
  fill("columns/dt_s", kNan);
  expect_refused(path_, "'dt_s' holds nan");
  fill("columns/force_x_N", 1e300);
  expect_refused(path_, "'force_x_N' holds 1e+300");
}

TEST_F(ChangedRecording, IsRefusedWithAGroupContainingItself) {
  change([](hid_t file) {
    H5Ldelete(file, "pictures", H5P_DEFAULT);
    H5Lcreate_hard(file, "/", file, "pictures", H5P_DEFAULT, H5P_DEFAULT);
  });
  expect_refused(path_, "has no column 'pictures/");
}

TEST_F(ChangedRecording, NothingIsReadFromAnotherFile) {
  const auto put = [this](const char* name, const std::function<void(hid_t file)>& how) {
    const std::string sound = bytes_of(path_);
    change([&](hid_t file) {
      H5Ldelete(file, name, H5P_DEFAULT);
      how(file);
    });
    expect_refused(path_, "is stored outside the file");
    write_bytes(path_, sound);
  };
  const fs::path other = folder_ / "other.h5";
  write_sample(other, 1500);
  put("columns/time_s", [&](hid_t file) {
    H5Lcreate_external(other.c_str(), "columns/time_s", file, "columns/time_s", H5P_DEFAULT, H5P_DEFAULT);
  });
  put("columns", [&](hid_t file) {
    H5Lcreate_external(other.c_str(), "columns", file, "columns", H5P_DEFAULT, H5P_DEFAULT);
  });
  const auto dataset = [&](const std::function<void(hid_t layout)>& lay_out) {
    put("columns/time_s", [&](hid_t file) {
      const hsize_t rows = 1500;
      const Hdf5Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
      const Hdf5Handle layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
      lay_out(layout.get());
      const Hdf5Handle made(H5Dcreate2(file, "columns/time_s", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT,
                                       layout.get(), H5P_DEFAULT),
                            H5Dclose);
      ASSERT_TRUE(made.valid());
    });
  };
  dataset([&](hid_t layout) { H5Pset_external(layout, other.c_str(), 0, H5F_UNLIMITED); });
  dataset([&](hid_t layout) {
    const hsize_t rows = 1500;
    const Hdf5Handle space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
    H5Pset_virtual(layout, space.get(), other.c_str(), "columns/time_s", space.get());
  });
  dataset([](hid_t layout) {
    constexpr H5Z_filter_t kOfTheirOwn = 40000;
    const hsize_t rows = 1500;
    H5Pset_chunk(layout, 1, &rows);
    H5Pset_filter(layout, kOfTheirOwn, H5Z_FLAG_OPTIONAL, 0, nullptr);
  });
}

TEST_F(ChangedRecording, IsRefusedWithAnInvalidColour) {
  change([this](hid_t file) {
    H5Adelete(file, "algorithm_colour");
    Attributes(path_, file).put("algorithm_colour", "red'; system 'ls");
  });
  expect_refused(path_, "label or colour of its algorithm");
}

TEST_F(ChangedRecording, IsRefusedWithAnUnknownFault) {
  change([](hid_t file) {
    const hid_t dataset = H5Dopen2(file, "columns/fault", H5P_DEFAULT);
    const std::vector<int> values(1500, 10);
    H5Dwrite(dataset, H5T_NATIVE_INT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(dataset);
  });
  expect_refused(path_, "'fault' holds 10");
}

TEST_F(ChangedRecording, IsRefusedWithoutItsVersionAttribute) {
  change([](hid_t file) { H5Adelete(file, "osteomill_recording_version"); });
  expect_refused(path_, "not an osteomill recording");
}

TEST_F(ChangedRecording, IsRefusedWhenTruncated) {
  for (const bool sealed : {true, false}) {
    if (!sealed) remove_seal();
    const std::string whole = bytes_of(path_);
    for (const double part : {0.0, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9999}) {
      write_bytes(path_, whole.substr(0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
      expect_refused(path_, part == 0 ? "not an HDF5 file"
                            : sealed  ? "damaged or truncated"
                                      : "cannot be opened");
    }
    write_bytes(path_, whole);
  }
}

// HDF5 itself crashes on some of these files, so they must be refused before it opens them.
TEST_F(ChangedRecording, IsRefusedWithASingleFlippedBit) {
  const std::string whole = bytes_of(path_);
  std::uint64_t state = 12345;
  for (int round = 0; round < 500; ++round) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    // Every second round damages HDF5's own structures, which are at the start of the file.
    const std::size_t span = (round % 2 == 0 ? 20000 : whole.size()) - kUserBlockBytes;
    const std::size_t at = kUserBlockBytes + (state >> 20) % span;
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (state >> 61)));
    write_bytes(path_, damaged);
    expect_refused(path_, "damaged or truncated");
  }
}

// Damaged files without a checksum, or with a valid checksum computed after the damage.
class DamagedRecording : public ChangedRecording, public ::testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(, DamagedRecording, ::testing::Bool(),
                         [](const auto& sealed) { return sealed.param ? "Sealed" : "Unsealed"; });

TEST_P(DamagedRecording, DoesNotCrashTheReader) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "HDF5 reads beyond its memory in the child, and loses some when it refuses";
#endif
  remove_seal();
  const std::string whole = bytes_of(path_);
  std::uint64_t state = 54321;
  for (int round = 0; round < 100; ++round) {
    std::string damaged = whole;
    for (int n = 0; n < 8; ++n) {
      state = state * 6364136223846793005u + 1442695040888963407u;
      damaged[kUserBlockBytes + (state >> 20) % (20000 - kUserBlockBytes)] = static_cast<char>(state >> 50);
    }
    write_bytes(path_, damaged);
    if (GetParam()) seal_elsewhere();
    try {
      read_recording(path_);
    } catch (const InputError& fault) {
      EXPECT_NE(std::string(fault.what()).find(path_.string()), std::string::npos);
    }
  }
}

TEST_F(ChangedRecording, IsReadWithoutItsChecksum) {
  remove_seal();
  EXPECT_EQ(read_recording(path_).records.size(), 1500u);
}

TEST(ReadRecording, RefusesMissingFilesFoldersAndOtherFormats) {
  const TestFolder folder;
  expect_refused(folder / "none.h5", "no such file");
  expect_refused(folder.path(), "is not a file");
  write_bytes(folder / "text.h5", "time_s,x_mm\n0,0\n");
  expect_refused(folder / "text.h5", "not an HDF5 file");
}

}  // namespace
}  // namespace osteomill
