#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace osteomill {

/// Exclusive lock on a file or folder among all programs that use this class. Held until the object is
/// destroyed or its program ends, in whatever way. A file system without such locks (folders on NFS) locks
/// nothing: every program gets the lock.
class FileLock {
 public:
  /// Returns nothing if `path` is locked by another holder or no longer exists.
  static std::optional<FileLock> try_lock(const std::filesystem::path& path);
  /// Creates an empty file and locks it. Throws InputError if the file exists or cannot be created.
  static FileLock create_locked(const std::filesystem::path& path);

  ~FileLock();
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  /// Returns whether `path` names the locked file.
  bool is_at(const std::filesystem::path& path) const;

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  bool try_lock() const;

  int descriptor_;
};

/// Returns whether a FileLock holds the file. From any thread; does not block.
bool is_locked(const std::filesystem::path& path);

/// Renames a file that an earlier program left ("r.part.h5") to the first free name ("r.part-1.h5") and
/// returns that name; nothing if there is no file. Throws InputError if a FileLock holds it, or it cannot be
/// renamed.
std::optional<std::filesystem::path> set_aside(const std::filesystem::path& path);

/// An output folder locked by this object: a second program that opens it is refused at once.
class OutputFolder {
 public:
  /// Creates the folder and its parents if missing. Throws InputError if that fails, or another program has
  /// locked it.
  explicit OutputFolder(std::filesystem::path folder);
  /// Removes the folders that this object created and that are still empty.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::filesystem::path folder_;
  // Created folders, innermost first.
  std::vector<std::filesystem::path> made_;
  std::optional<FileLock> lock_;
};

}  // namespace osteomill
