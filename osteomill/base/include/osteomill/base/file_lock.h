#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace osteomill {

/// Holds a file or a folder for this object alone, among all programs that ask the same way, until it is
/// destroyed or its program ends, however that ends. A file system without such locks (folders on NFS) locks
/// nothing: there every program gets the lock.
class FileLock {
 public:
  /// Returns nothing if another one holds `path`, or if the file is no longer there.
  static std::optional<FileLock> try_lock(const std::filesystem::path& path);
  /// Creates an empty file and holds it. Throws InputError if there is one already, or none can be created.
  static FileLock create_locked(const std::filesystem::path& path);

  ~FileLock();
  FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileLock& operator=(FileLock&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }

  /// Returns whether the file of that name is the one that is held.
  bool is_at(const std::filesystem::path& path) const;

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  bool try_lock() const;

  int descriptor_;
};

/// Returns whether a FileLock holds the file. From any thread; waits for nothing.
bool is_locked(const std::filesystem::path& path);

/// Renames a file that an earlier program left ("r.part.h5") to the first name that is free ("r.part-1.h5"),
/// which is returned; nothing if there is no file. Throws InputError if a FileLock holds it, or it cannot be
/// renamed.
std::optional<std::filesystem::path> set_aside(const std::filesystem::path& path);

/// A folder for output, held by this object alone: a second program that wants it is refused at once.
class OutputFolder {
 public:
  /// Creates it, and its parents, if it is not there. Throws InputError if that is impossible, or another
  /// program holds it.
  explicit OutputFolder(std::filesystem::path folder);
  /// Removes what was created here and is still empty.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

 private:
  std::filesystem::path folder_;
  // The innermost first.
  std::vector<std::filesystem::path> made_;
  std::optional<FileLock> lock_;
};

}  // namespace osteomill
