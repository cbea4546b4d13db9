#include "osteomill/files/atomic_file.h"

#include <fstream>
#include <sstream>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "osteomill/files/input_error.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        fs::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string content(const fs::path& path) const {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
  }
  long file_count() const { return std::distance(fs::directory_iterator(folder_), fs::directory_iterator()); }

  fs::path folder_;
};

TEST_F(AtomicFileTest, WritesTheText) {
  write_text_atomically(folder_ / "a.csv", [](std::ostream& out) { out << "1,2\n"; });
  EXPECT_EQ(content(folder_ / "a.csv"), "1,2\n");
  EXPECT_EQ(file_count(), 1);
}

TEST_F(AtomicFileTest, AFailedWriteLeavesTheOldFileAndNoOther) {
  write_text_atomically(folder_ / "a.csv", [](std::ostream& out) { out << "old"; });
  EXPECT_THROW(write_text_atomically(folder_ / "a.csv",
                                     [](std::ostream& out) {
                                       out << "half";
                                       throw std::runtime_error("stopped");
                                     }),
               std::runtime_error);
  EXPECT_EQ(content(folder_ / "a.csv"), "old");
  EXPECT_EQ(file_count(), 1);
}

TEST_F(AtomicFileTest, ALinkStaysAndWhatItLeadsToIsWritten) {
  std::ofstream(folder_ / "real.csv") << "old";
  fs::create_symlink("real.csv", folder_ / "link.csv");
  fs::create_symlink("later.csv", folder_ / "ahead.csv");
  for (const char* link : {"link.csv", "ahead.csv"})
    write_text_atomically(folder_ / link, [](std::ostream& out) { out << "new"; });
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.csv"));
  EXPECT_EQ(content(folder_ / "real.csv"), "new");
  EXPECT_EQ(content(folder_ / "later.csv"), "new");
  EXPECT_EQ(file_count(), 4);
}

TEST_F(AtomicFileTest, WhatIsNoFileIsWrittenInto) {
  const fs::path pipe = folder_ / "pipe.csv";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read;
  std::thread reader([&] { read = content(pipe); });
  write_text_atomically(pipe, [](std::ostream& out) { out << "1,2\n"; });
  reader.join();
  EXPECT_EQ(read, "1,2\n");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(file_count(), 1);
}

TEST_F(AtomicFileTest, AFolderIsNamed) {
  EXPECT_THROW(write_text_atomically(folder_, [](std::ostream&) {}), InputError);
}

TEST_F(AtomicFileTest, AFolderThatIsMissingIsNamed) {
  try {
    write_text_atomically(folder_ / "none" / "a.csv", [](std::ostream&) {});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("none/a.csv"), std::string::npos);
  }
}

TEST_F(AtomicFileTest, WhatIsReadIsNotToBeWritten) {
  const fs::path scan = folder_ / "scan.nrrd";
  std::ofstream(scan) << "mine";
  fs::create_symlink(scan, folder_ / "link.nrrd");
  EXPECT_THROW(require_no_input(scan, {"", scan}), InputError);
  EXPECT_THROW(require_no_input(folder_ / "link.nrrd", {scan}), InputError);
  // A slice of a folder that is read.
  EXPECT_THROW(require_no_input(scan, {folder_}), InputError);
  EXPECT_NO_THROW(require_no_input(folder_ / "new.nrrd", {scan, folder_}));
  EXPECT_NO_THROW(require_no_input(scan, {"", folder_ / "none"}));
}

}  // namespace
}  // namespace osteomill
