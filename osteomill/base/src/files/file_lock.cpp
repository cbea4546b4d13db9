#include "osteomill/base/file_lock.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <system_error>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "osteomill/base/atomic_file.h"
#include "osteomill/base/input_error.h"

namespace osteomill {

namespace fs = std::filesystem;

namespace {

constexpr const char* kLockedByOther = "another program is writing to it";

// Does not block on a FIFO.
int open_for_check(const fs::path& path) {
  return ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
}

// Renames a file if the new name is free; otherwise returns false with errno EEXIST. NFS does not support
// RENAME_NOREPLACE.
bool rename_to_free_name(const fs::path& from, const fs::path& to) {
  if (::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL) return false;
  return ::link(from.c_str(), to.c_str()) == 0 && ::unlink(from.c_str()) == 0;
}

[[noreturn]] void refuse(const fs::path& path, const char* what) {
  throw InputError(path.string(), std::string(what) + std::strerror(errno));
}

}  // namespace

bool FileLock::try_lock() const {
  return ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

bool FileLock::is_at(const fs::path& path) const {
  struct stat held {};
  struct stat named {};
  return ::fstat(descriptor_, &held) == 0 && ::stat(path.c_str(), &named) == 0 &&
         held.st_ino == named.st_ino && held.st_dev == named.st_dev;
}

// Checks the name again: the previous holder may have renamed or removed the file.
std::optional<FileLock> FileLock::try_lock(const fs::path& path) {
  FileLock lock(open_for_check(path));
  if (lock.descriptor_ < 0 || !lock.try_lock() || !lock.is_at(path)) return std::nullopt;
  return lock;
}

// Between open and lock another program may take the file for a leftover.
FileLock FileLock::create_locked(const fs::path& path) {
  FileLock lock(::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (lock.descriptor_ < 0) refuse(path, "cannot be created: ");
  if (!lock.try_lock() || !lock.is_at(path)) throw InputError(path.string(), kLockedByOther);
  return lock;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool is_locked(const fs::path& path) {
  const int descriptor = open_for_check(path);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

std::optional<fs::path> set_aside(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(fs::symlink_status(path, error))) return std::nullopt;
  const auto lock = FileLock::try_lock(path);
  if (!lock) throw InputError(path.string(), kLockedByOther);
  for (int number = 1;; ++number) {
    const fs::path name = path.parent_path() /
                          (path.stem().string() + "-" + std::to_string(number) + path.extension().string());
    if (rename_to_free_name(path, name)) return name;
    if (errno != EEXIST) refuse(path, "exists and cannot be renamed: ");
  }
}

OutputFolder::OutputFolder(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  for (fs::path path = folder_; !path.empty() && !fs::exists(path, error); path = path.parent_path())
    made_.push_back(path);
  create_folder(folder_);
  lock_ = FileLock::try_lock(folder_);
  if (!lock_) throw InputError(folder_.string(), kLockedByOther);
}

OutputFolder::~OutputFolder() {
  for (const fs::path& path : made_) ::rmdir(path.c_str());
}

}  // namespace osteomill
