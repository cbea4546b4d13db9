#include "osteomill/base/atomic_file.h"

#include <array>
#include <fstream>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/input_files.h"

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

TEST_F(AtomicFileTest, FailedWriteKeepsTheOldFileAndLeavesNoOther) {
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

TEST_F(AtomicFileTest, WritesToTheTargetOfALinkInsteadOfReplacingIt) {
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

TEST_F(AtomicFileTest, WritesIntoAFifoInsteadOfReplacingIt) {
  const fs::path pipe = folder_ / "pipe.csv";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  write_text_atomically(pipe, [](std::ostream&) {});
  write_text_atomically(pipe, [](std::ostream& out) { out << "1,2\n"; });
  std::array<char, 9> read{};
  EXPECT_EQ(::read(reader, read.data(), read.size()), 4);
  ::close(reader);
  EXPECT_STREQ(read.data(), "1,2\n");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(file_count(), 1);
}

TEST_F(AtomicFileTest, RefusesAFolderAsTheFile) {
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

TEST_F(AtomicFileTest, RefusesAPipeWithoutAReader) {
  const fs::path pipe = folder_ / "pipe.csv";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(write_text_atomically(pipe, [](std::ostream&) { FAIL(); }), InputError);
}

TEST_F(AtomicFileTest, RefusesToOverwriteAnInputByAnyOfItsNames) {
  const fs::path scan = folder_ / "scan.nrrd";
  std::ofstream(scan) << "mine";
  fs::create_symlink(scan, folder_ / "link.nrrd");
  fs::create_hard_link(scan, folder_ / "other.nrrd");
  register_input(scan);
  EXPECT_EQ(output_path(scan), scan);
  const InputProtection input_protection;
  EXPECT_EQ(output_path(scan), scan);
  register_input(folder_ / "link.nrrd");
  for (const char* name : {"scan.nrrd", "link.nrrd", "other.nrrd"})
    EXPECT_THROW(output_path(folder_ / name), InputError) << name;
  EXPECT_THROW(write_folder_atomically(
                   folder_, [](const fs::path& beside) { std::ofstream(beside / "other.nrrd") << "new"; }),
               InputError);
  EXPECT_EQ(content(scan), "mine");
  EXPECT_NO_THROW(output_path(folder_ / "new.nrrd"));
  // A later file of that name, or with that inode, is a different file.
  fs::remove(scan);
  EXPECT_NO_THROW(output_path(folder_ / "other.nrrd"));
}

TEST_F(AtomicFileTest, ReplacesFilesOnlyOnceTheWholeFolderIsWritten) {
  std::ofstream(folder_ / "kept.csv") << "kept";
  std::ofstream(folder_ / "a.csv") << "old";
  write_folder_atomically(folder_, [&](const fs::path& beside) {
    create_folder(beside / "figures");
    std::ofstream(beside / "figures" / "b.svg") << "b";
    std::ofstream(beside / "a.csv") << "new";
    EXPECT_EQ(content(folder_ / "a.csv"), "old");
  });
  EXPECT_EQ(content(folder_ / "a.csv"), "new");
  EXPECT_EQ(content(folder_ / "figures" / "b.svg"), "b");
  EXPECT_EQ(file_count(), 3);
}

TEST_F(AtomicFileTest, ReportsTheFinalPathOfAFileThatFails) {
  const fs::path new_folder = folder_ / "new";
  try {
    write_folder_atomically(new_folder, [](const fs::path& beside) {
      write_folder_atomically(beside, [](const fs::path& within) {
        throw InputError((within / "a.csv").string(), "cannot be written: no");
      });
    });
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(), (new_folder / "a.csv").string() + ": cannot be written: no");
  }
}

TEST_F(AtomicFileTest, RemovesAllFilesOfAFolderIfOneFails) {
  const auto fail = [](const fs::path& beside) {
    std::ofstream(beside / "a.csv") << "half";
    throw InputError("b.csv", "cannot be written");
  };
  EXPECT_THROW(write_folder_atomically(folder_ / "new", fail), InputError);
  EXPECT_EQ(file_count(), 0);
  // Also if the failure occurs only while moving the files.
  fs::create_directories(folder_ / "b.csv");
  EXPECT_THROW(write_folder_atomically(folder_,
                                       [](const fs::path& beside) {
                                         std::ofstream(beside / "a.csv") << "whole";
                                         std::ofstream(beside / "b.csv") << "whole";
                                       }),
               InputError);
  EXPECT_EQ(file_count(), 1);
}

TEST_F(AtomicFileTest, RemovesStaleFilesOnlyAfterASuccessfulWrite) {
  for (const char* name : {"a.h5", "b.h5", "notes.txt"}) std::ofstream(folder_ / name) << "old";
  const auto stale = [](const std::string& name) { return name.ends_with(".h5"); };
  const auto write = [&](const fs::path& beside) {
    EXPECT_TRUE(fs::exists(folder_ / "b.h5")) << "old files stay until the new ones are written";
    std::ofstream(beside / "a.h5") << "new";
  };
  write_folder_atomically(folder_, write, stale);
  EXPECT_FALSE(fs::exists(folder_ / "b.h5"));
  EXPECT_EQ(content(folder_ / "a.h5"), "new");
  EXPECT_EQ(content(folder_ / "notes.txt"), "old");
  EXPECT_THROW(write_folder_atomically(
                   folder_, [](const fs::path&) { throw InputError("x", "y"); }, stale),
               InputError);
  EXPECT_EQ(content(folder_ / "a.h5"), "new") << "a failed write replaces nothing";
}

// The child exits within `write`, like a killed process.
TEST_F(AtomicFileTest, RemovesFoldersOfKilledProgramsButNotOfRunningOnes) {
  const ::pid_t child = ::fork();
  if (child == 0) {
    write_folder_atomically(folder_, [](const fs::path& beside) {
      std::ofstream(beside / "a.h5") << "half";
      ::_exit(0);
    });
  }
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(fs::exists(folder_ / ".files.writing-1"));
  write_folder_atomically(folder_, [&](const fs::path& outer) {
    EXPECT_EQ(outer, folder_ / ".files.writing-1") << "the name is free again";
    write_folder_atomically(folder_, [&](const fs::path& inner) {
      EXPECT_NE(inner, outer);
      std::ofstream(inner / "b.h5") << "b";
    });
    std::ofstream(outer / "a.h5") << "whole";
  });
  EXPECT_EQ(content(folder_ / "a.h5"), "whole");
  EXPECT_EQ(content(folder_ / "b.h5"), "b");
  EXPECT_EQ(file_count(), 2);
}

}  // namespace
}  // namespace osteomill
