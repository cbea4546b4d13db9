#include "osteomill/base/file_lock.h"

#include <fstream>

#include <gtest/gtest.h>

#include "osteomill/base/input_error.h"
#include "osteomill/base/temporary_folder.h"

namespace osteomill {
namespace {

namespace fs = std::filesystem;

TEST(FileLock, LocksAFileExclusivelyUntilDestroyed) {
  const TemporaryFolder folder;
  const fs::path path = folder / "a.h5";
  EXPECT_FALSE(FileLock::try_lock(path));
  {
    const FileLock lock = FileLock::create_locked(path);
    EXPECT_TRUE(is_locked(path));
    EXPECT_FALSE(FileLock::try_lock(path));
    EXPECT_THROW(FileLock::create_locked(path), InputError);
    EXPECT_TRUE(lock.is_at(path));
    fs::rename(path, folder / "b.h5");
    EXPECT_FALSE(lock.is_at(path));
    EXPECT_TRUE(is_locked(folder / "b.h5"));
  }
  EXPECT_FALSE(is_locked(folder / "b.h5"));
  EXPECT_TRUE(FileLock::try_lock(folder / "b.h5"));
}

TEST(FileLock, RenamesLeftoversButNotLockedFiles) {
  const TemporaryFolder folder;
  const fs::path path = folder / "r.part.h5";
  EXPECT_FALSE(set_aside(path));
  std::ofstream(path) << "first";
  EXPECT_EQ(set_aside(path), folder / "r.part-1.h5");
  std::ofstream(path) << "second";
  EXPECT_EQ(set_aside(path), folder / "r.part-2.h5");
  EXPECT_EQ(fs::file_size(folder / "r.part-1.h5"), 5u);
  EXPECT_EQ(fs::file_size(folder / "r.part-2.h5"), 6u);
  const FileLock lock = FileLock::create_locked(path);
  EXPECT_THROW(set_aside(path), InputError);
  EXPECT_TRUE(lock.is_at(path));
}

TEST(OutputFolder, RefusesASecondOwnerAndIsRemovedIfEmpty) {
  const TemporaryFolder folder;
  const fs::path path = folder / "new" / "out";
  {
    const OutputFolder owner(path);
    EXPECT_THROW(OutputFolder{path}, InputError);
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
  {
    const OutputFolder owner(path);
    std::ofstream(path / "a.csv") << "1";
  }
  EXPECT_TRUE(fs::exists(path / "a.csv"));
}

}  // namespace
}  // namespace osteomill
